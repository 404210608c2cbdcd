// Each message byte by byte, as protocol/README.md says.
#include "tests/support/catch.h"
#include "tests/support/one_of_each.h"

using namespace palpate;
using namespace palpate::test;

TEST_CASE("golden bytes: written down by hand from protocol/README.md") {
  const auto front = [](const char* type, const char* payload) {
    return std::string("504c5054") + "02" + type + payload +
           "00"
           "000000"
           "8877665544332211"
           "0700000000000000";
  };
  const auto messages = one_of_each();
  CHECK(hex(encoded(kHeader, messages[0])) == front("01", "0001") + "2a00000000000000" +
                                                  std::string(2 * 24, '0') + "0500000000000000" +
                                                  std::string(2 * 216, '0'));
  CHECK(hex(encoded(kHeader, messages[14])) == front("02", "2800") +
                                                   "2a000000000000000000000000000000"
                                                   "0500000000000000"
                                                   "2d000000000000002e00000000000000");
  CHECK(hex(encoded(kHeader, messages[1])) == front("03", "4900") +
                                                  "2a000000000000000000000000000000"
                                                  "0500000000000000"
                                                  "2b000000000000002c00000000000000"
                                                  "01"
                                                  "0000000000003e40"
                                                  "7b14ae47e17a743f"
                                                  "01000000020000000300000004030201");
  CHECK(hex(encoded(kHeader, messages[2])) == front("04", "1900") +
                                                  "2a000000000000000000000000000000"
                                                  "0500000000000000"
                                                  "01");
  CHECK(hex(encoded(kHeader, messages[3])) == front("05", "0000"));
  CHECK(hex(encoded(kHeader, messages[4])) == front("06", "6d00") +
                                                  "01"
                                                  "0900000000000000"
                                                  "0800000000000000"
                                                  "15cd5b0700000000"
                                                  "000000000000e03f"
                                                  "000000000000f0bf"
                                                  "0000000000000040"
                                                  "0000000000000000"
                                                  "000000000000d03f"
                                                  "0000000000000000"
                                                  "000000000000f03f"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "05000000");
  CHECK(hex(encoded(kHeader, messages[5])) == front("07", "6d00") +
                                                  "01"
                                                  "0300000000000000"
                                                  "0900000000000000"
                                                  "15cd5b0700000000"
                                                  "000000000000e03f"
                                                  "000000000000f0bf"
                                                  "0000000000000040"
                                                  "0000000000000000"
                                                  "000000000000f83f"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "0000000000000000"
                                                  "7011010000000000"
                                                  "01000000");
  CHECK(hex(encoded(kHeader, messages[8])).substr(2 * (28 + 107)) ==
        "6000"  // flags, then: pages taken, version, pages
        "0302000000000000"
        "d4c3b2a1"
        "0700000008000000090000000a0000000b0000000c0000000d000000ffffffff");
  CHECK(hex(encoded(kHeader, messages[9])).substr(2 * (28 + 105)) ==
        "10000000"  // flags, then: version, vertices, triangles, radius, friction, compliance, shift
        "d4c3b2a1"
        "62010000"
        "c0020000"
        "000000000000e03f"
        "000000000000d03f"
        "0000000000000040"
        "0000000000000000"
        "000000000000e0bf"
        "0000000000000000");
  CHECK(hex(encoded(kHeader, messages[11])).substr(2 * (28 + 105)) ==
        "20000000"  // flags, then: source and percent of the mesh, source and percent of the time step
        "01"
        "00006040"
        "03"
        "00000000");
  CHECK(hex(encoded(kHeader, messages[12])).substr(2 * (28 + 105)) ==
        "40000000"  // flags, then: velocity, compliance
        "000000000000e03f"
        "0000000000000000"
        "000000000000f0bf"
        "000000000000f0bf"
        "00000000000000c0"
        "00000000000008c0"
        "00000000000010c0"
        "00000000000014c0"
        "00000000000018c0");
  CHECK(hex(encoded(kHeader, messages[13])).substr(2 * (28 + 105)) ==
        "80010000"
        "02"
        "0000003f00000040"
        "000080bf00000000"
        "0000000000000000000000000000f83f0000000000000000");
  CHECK(hex(encoded(kHeader, messages[15])).substr(2 * (28 + 105)) ==
        "80020000"
        "020000003f00000040000080bf00000000"
        "02"  // terms: share and time of each
        "0000003f0000003e"
        "0000803e00000040"
        "0101"  // first mode, count: both terms of it
        "000080bf00004040"
        "01"  // vertices: number, both terms
        "0201"
        "0000803f0000004000004040"
        "0000003f00000000000000bf");
  CHECK(hex(encoded(kHeader, messages[18])).substr(2 * (28 + 105)) ==
        "80100000"
        "020000003f00000040000080bf00000000"
        "02"  // modes that are driven, and how hard
        "000000bf00004040");
  CHECK(hex(encoded(kHeader, messages[10])) == front("0a", "8d03") + "01" + "d4c3b2a1" + "08070000" +
                                                   "0000003f" + std::string(2 * 4 * 223, '0') + "000000c0");
  CHECK(hex(encoded(kHeader, messages[6])).substr(2 * (28 + 107)) ==
        "1800"
        "3020100000000000");
  CHECK(hex(encoded(kHeader, messages[7])).substr(2 * (28 + 105)) ==
        "0c000000"  // flags, then: surface velocity, tangent, normal, gap
        "000000000000d03f"
        "0000000000000000"
        "000000000000e0bf"
        "000000000000f0bf"
        "00000000000000c0"
        "00000000000008c0"
        "00000000000010c0"
        "00000000000014c0"
        "00000000000018c0"
        "0000000000000000"
        "000000000000f03f"
        "0000000000000000"
        "000000000000e03f"
        // place ahead, force there, tangent, normal, gap
        "000000000000e03f"
        "000000000000f0bf"
        "0000000000000040"
        "0000000000000000"
        "000000000000f83f"
        "0000000000000000"
        "00000000000020c0"
        "0000000000000000"
        "0000000000000000"
        "00000000000030c0"
        "0000000000000000"
        "00000000000040c0"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000");
  CHECK(hex(encoded(kHeader, messages[16])) == front("08", "f200") +
                                                   "01"
                                                   "0500"
                                                   "15cd5b0700000000"
                                                   "80841e00"
                                                   "000000000000e03f"
                                                   "000000000000f0bf"
                                                   "0000000000000040"
                                                   "0000000000000000"
                                                   "000000000000f83f"
                                                   "0000000000000000"
                                                   "0403020100000000"
                                                   "80841e00"
                                                   "06050000"
                                                   "0900000000000000"
                                                   "0200000000000000"
                                                   "0000003f"
                                                   "01000000020000000300000004000000" +
                                                   "6d65" + std::string(60, '0') + "613a2062" +
                                                   std::string(56, '0') + "01" + "63" + std::string(62, '0') +
                                                   "000080bf"
                                                   "02"
                                                   "02"
                                                   "0000003f"
                                                   "00000040"
                                                   "0000803f"
                                                   "000000c0"
                                                   "00004040"
                                                   "0000003f");
  CHECK(hex(encoded(kHeader, messages[17])) == front("09", "2300") +
                                                   "01"
                                                   "0201000000000000"
                                                   "000000000000e03f"
                                                   "000000000000f0bf"
                                                   "0000000000000040"
                                                   "0500");
}
