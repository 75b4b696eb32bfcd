#!/usr/bin/python3
"""Reads Prometheus' text format from standard input by the parser of its Python library, another one than promtool's.

Prints NAME{LABELS} VALUE of each sample, labels in alphabetical order. Fails where a counter's name does not end in
_total, a metric has no help, a series comes twice, or a histogram's buckets fall."""
import sys

from prometheus_client.parser import text_string_to_metric_families

seen = set()
for family in text_string_to_metric_families(sys.stdin.read()):
    assert family.documentation, family.name
    assert family.type != "unknown", family.name
    below = {}
    for sample in family.samples:
        labels = ",".join(f'{name}="{value}"' for name, value in sorted(sample.labels.items()))
        series = f"{sample.name}{{{labels}}}"
        assert series not in seen, series
        seen.add(series)
        if family.type == "counter":
            assert sample.name.endswith("_total"), sample.name
        if sample.name.endswith("_bucket"):
            key = tuple(sorted((name, value) for name, value in sample.labels.items() if name != "le"))
            assert sample.value >= below.get(key, 0), series
            below[key] = sample.value
        print(series, f"{sample.value:.6f}".rstrip("0").rstrip("."))
assert seen, "nothing to read"
