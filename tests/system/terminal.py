#!/usr/bin/env python3
"""demo on a terminal, in its background, and without one. Needs neither CAN nor a broker."""
import fcntl
import json
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import termios
import time
import tty
import urllib.request

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), '../..'))
PROGRAM = [os.environ['GATEWAY_BIN'], '--profile-dir', os.path.join(ROOT, 'config/profiles')]
WORK = tempfile.mkdtemp(prefix='terminal-test.')
SITE = '[[bus]]\nname = "can0"\n[modbus]\n' + ''.join(
    f'[[drive]]\nname = "fan{node}"\nnode = {node}\nprofile = "cia402-velocity"\n' for node in range(1, 31))
SECONDS = 30
checks = 0


def expect(what, good, seen=''):
    global checks
    if not good:
        print(f'FAILED: {what}\n{str(seen)[-4000:]}')
        sys.exit(1)
    checks += 1


def until(what, look, seen=lambda: ''):
    """What `look` gives once it gives something."""
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        found = look()
        if found:
            return found
        time.sleep(0.05)
    expect(f'not within {SECONDS} s: {what}', False, seen())


class Terminal:
    """A terminal with a session whose leader does nothing but wait, and a demo in it as a process group of its own."""

    def __init__(self, foreground):
        self.output = ''
        self.master, self.slave = os.openpty()
        self.before = fcntl.fcntl(self.slave, fcntl.F_GETFL)
        numbers, report = os.pipe()
        self.leader = os.fork()
        if self.leader == 0:
            os.setsid()
            fcntl.ioctl(self.slave, termios.TIOCSCTTY, 0)
            signal.signal(signal.SIGTTOU, signal.SIG_IGN)  # so that it may hand the terminal on
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
            child = os.fork()
            if child == 0:
                os.setpgid(0, 0)
                signal.signal(signal.SIGTTOU, signal.SIG_DFL)
                signal.signal(signal.SIGHUP, signal.SIG_DFL)
                if foreground:
                    # As a shell does it: whoever is in the background may do so only while SIGTTOU is blocked.
                    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTTOU})
                    os.tcsetpgrp(self.slave, os.getpgrp())
                    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTTOU})
                for descriptor in (0, 1, 2):
                    os.dup2(self.slave, descriptor)
                os.environ['TMPDIR'] = WORK
                os.execv(PROGRAM[0], [*PROGRAM, '--config', os.path.join(WORK, 'site.toml'), 'demo'])
            os.write(report, b'%d\n' % child)
            os.close(self.master)
            while True:
                _, status = os.waitpid(child, os.WUNTRACED)
                if not os.WIFSTOPPED(status):
                    break
            os.write(report, b'%d\n' % os.waitstatus_to_exitcode(status))
            os._exit(0)
        os.close(report)
        self.numbers = os.fdopen(numbers)
        self.demo = int(self.numbers.readline())

    def read(self):
        while select.select([self.master], [], [], 0)[0]:
            try:
                data = os.read(self.master, 65536)
            except OSError:
                return
            if not data:
                return
            self.output += data.decode(errors='replace')

    def says(self, pattern, after=0):
        def look():
            self.read()
            return re.search(pattern, self.output[after:])
        return until(f'it says {pattern}', look, lambda: self.output)

    def type(self, text):
        os.write(self.master, text.encode())

    def state(self):
        with open(f'/proc/{self.demo}/stat') as stat:
            return stat.read().rsplit(')', 1)[1].split()[0]

    def exit_code(self):
        code = int(self.numbers.readline())
        os.waitpid(self.leader, 0)
        return code

    def close(self):
        os.close(self.master)
        os.close(self.slave)


def health(page):
    with urllib.request.urlopen(page + 'health', timeout=5) as answer:
        return json.load(answer)


def online(page):
    try:
        return health(page)['drives_online'] == 30
    except OSError:
        return False


def in_the_foreground():
    terminal = Terminal(foreground=True)
    page = terminal.says(r'The page: (http://127\.0\.0\.1:\d+/)')[1]
    expect('the address of the page comes first', terminal.output.startswith('The page: '), terminal.output[:400])
    until('all drives are online', lambda: online(page))
    start = len(terminal.output)
    terminal.type('list\n')
    terminal.says(r'node=30 kind=cia402-velocity', start)
    now = fcntl.fcntl(terminal.slave, fcntl.F_GETFL)
    expect('the terminal of the shell is as it was', now == terminal.before, f'{terminal.before:o} {now:o}')

    # Another size of the window is no end.
    fcntl.ioctl(terminal.master, termios.TIOCSWINSZ, b'\x28\x00\x78\x00\x00\x00\x00\x00')
    os.kill(terminal.demo, signal.SIGWINCH)
    start = len(terminal.output)
    terminal.type('1 show\n')
    terminal.says(r'node=1 kind=', start)

    # Ctrl-S: the drives go on, and what was to be shown comes after Ctrl-Q.
    terminal.type('\x13')
    time.sleep(0.2)
    terminal.read()
    start = len(terminal.output)
    time.sleep(9)
    terminal.read()
    expect('the terminal stands still', len(terminal.output) - start < 200, terminal.output[start:])
    expect('the drives do not', online(page))
    terminal.type('\x11')
    terminal.says(r'(?s)(fan30 .*){4}', start)

    terminal.type('\x03')
    expect('Ctrl-C ends it', terminal.exit_code() == 0)
    now = fcntl.fcntl(terminal.slave, fcntl.F_GETFL)
    expect('it leaves the terminal as it was', now == terminal.before)
    terminal.close()


def in_the_background():
    terminal = Terminal(foreground=False)
    page = terminal.says(r'The page: (http://127\.0\.0\.1:\d+/)')[1]
    until('all drives are online', lambda: online(page))
    # With `stty tostop` even writing stops who is not told to go on.
    mode = termios.tcgetattr(terminal.slave)
    mode[tty.LFLAG] |= termios.TOSTOP
    termios.tcsetattr(terminal.slave, termios.TCSANOW, mode)
    start = len(terminal.output)
    terminal.type('list\n')
    terminal.says(r'fan30 ', start)
    time.sleep(1.5)
    terminal.read()
    expect('it is not stopped', terminal.state() in 'RS', terminal.state())
    expect('the line is not for it', 'node=30' not in terminal.output[start:], terminal.output[start:])
    expect('it goes on', online(page))
    os.kill(terminal.demo, signal.SIGTERM)
    expect('SIGTERM ends it', terminal.exit_code() == 0)
    terminal.close()


def where_the_terminal_goes():
    terminal = Terminal(foreground=True)
    page = terminal.says(r'The page: (http://127\.0\.0\.1:\d+/)')[1]
    until('all drives are online', lambda: online(page))
    terminal.close()
    os.kill(terminal.demo, signal.SIGHUP)
    expect('the end of the terminal ends it', terminal.exit_code() in (0, 1))


def launched(*, name, **options):
    return subprocess.Popen([*PROGRAM, '--config', os.path.join(WORK, 'site.toml'), 'demo'],
                            stdout=open(os.path.join(WORK, name), 'w'), stderr=subprocess.DEVNULL,
                            env={**os.environ, 'TMPDIR': WORK}, **options)


def page_of(name):
    def look():
        with open(os.path.join(WORK, name)) as text:
            return re.search(r'The page: (\S+)', text.read())
    return until(f'{name}: the page', look)[1]


def without_a_terminal():
    pages = {}
    demos = {}
    for name, options in (
            ('closed', {'stdin': None, 'preexec_fn': lambda: os.close(0)}),
            ('nohup', {'stdin': subprocess.DEVNULL,
                       'preexec_fn': lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)}),
            ('piped', {'stdin': subprocess.PIPE})):
        demos[name] = launched(name=name, **options)
        pages[name] = page_of(name)
        until(f'{name}: all drives are online', lambda page=pages[name]: online(page))
    expect('three demos have three pages', len(set(pages.values())) == 3, pages)
    with open(os.path.join(WORK, 'piped')) as text:
        expect('the next one says where it is', 'is taken, by another demo or gateway perhaps' in text.read())
    demos['nohup'].send_signal(signal.SIGHUP)
    piped = demos['piped']
    piped.stdin.write(b'list\n')
    piped.stdin.flush()
    until('what comes by a pipe is answered',
          lambda: 'node=30 kind=' in open(os.path.join(WORK, 'piped')).read())
    piped.stdin.close()
    time.sleep(0.5)
    for name, demo in demos.items():
        expect(f'{name}: it goes on', demo.poll() is None and online(pages[name]))
        demo.send_signal(signal.SIGTERM)
        expect(f'{name}: it ends in order', demo.wait(SECONDS) == 0)


with open(os.path.join(WORK, 'site.toml'), 'w') as site:
    site.write(SITE)
try:
    in_the_foreground()
    in_the_background()
    where_the_terminal_goes()
    without_a_terminal()
    left = [name for name in os.listdir(WORK) if name.startswith('canopen-gateway.')]
    expect('no temporary directory is left', not left, left)
finally:
    shutil.rmtree(WORK, ignore_errors=True)
print(f'passed, {checks} expectations')
