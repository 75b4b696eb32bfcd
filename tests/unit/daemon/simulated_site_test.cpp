#include "daemon/simulated_site.h"

#include <gmock/gmock.h>

#include "canopen/bus/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SimulatedSiteTest : public testing::Test {
 protected:
  /// Why the model's drives cannot be simulated; empty where they can.
  std::string objection(const config::Model& model) {
    SimulatedSite site(loop_.executor());
    try {
      site.add_drives(site.add_network(wire_.connect()), model, 0);
    } catch (const NotSimulated& reason) {
      return reason.what();
    }
    return "";
  }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
};

TEST_F(SimulatedSiteTest, HasADriveForEachOfTheModel) {
  EXPECT_EQ(objection(test::demo_model()), "");
}

TEST_F(SimulatedSiteTest, NamesTheKindsWhereAProfileIsNone) {
  config::Model model = test::demo_model();
  model.drives[1].profile = "our-pump";
  EXPECT_THAT(objection(model), AllOf(HasSubstr("drive \"pump1\": unknown kind of drive \"our-pump\""),
                                      HasSubstr("veichi-ac300, veichi-ac310, invt-goodrive600, vacon-opte6")));
}

TEST_F(SimulatedSiteTest, GivesEachDriveItsOwnNode) {
  config::Model model = test::demo_model();
  model.drives[1].node.node = model.drives[0].node.node;
  EXPECT_THAT(objection(model), HasSubstr("drive \"pump1\": node 3 is simulated already"));
}

}  // namespace
}  // namespace gateway
