// Reads 3MF packages made here, as programs write them: what is solid, where it is, and what is
// left out.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"
#include "tests/mesh/zip_file.h"

namespace vpm::test {
namespace {

constexpr double kExact = 1e-12;

bool reads_threemf() {
  try {
    parse("PK\x03\x04", "a.3mf");
  } catch (const Error& fault) {
    return fault.kind() != ErrorKind::unavailable;
  }
  return true;
}

class Threemf : public testing::Test {
 protected:
  void SetUp() override {
    if (!reads_threemf()) GTEST_SKIP() << "no expat";
  }
};

std::string decimal(double number) {
  return std::to_string(number);
}

// Returns vertices and triangles of a cube of this edge, centred at x, that begin at vertex
// `first`.
std::pair<std::string, std::string> cube(double edge, double x = 0, std::uint32_t first = 0) {
  const Solid solid = synthetic::make_cube(edge);
  std::string vertices, triangles;
  for (const Vec3& v : solid.vertices) {
    vertices += "<vertex x=\"" + decimal(v.x + x) + "\" y=\"" + decimal(v.y) + "\" z=\"" +
                decimal(v.z) + "\"/>";
  }
  for (const Triangle& t : solid.triangles) {
    triangles += "<triangle v1=\"" + std::to_string(first + t[0]) + "\" v2=\"" +
                 std::to_string(first + t[1]) + "\" v3=\"" + std::to_string(first + t[2]) + "\"/>";
  }
  return {vertices, triangles};
}

std::string mesh_of(const std::pair<std::string, std::string>& parts,
                    const std::string& more = "") {
  return "<mesh><vertices>" + parts.first + "</vertices><triangles>" + parts.second +
         "</triangles>" + more + "</mesh>";
}

std::string object(int id, const std::string& attributes, const std::string& content) {
  return "<object id=\"" + std::to_string(id) + "\" " + attributes + ">" + content + "</object>";
}

std::string object(int id, double edge, const std::string& attributes = "", double x = 0) {
  return object(id, attributes, mesh_of(cube(edge, x)));
}

std::string component(int id, const std::string& attributes = "") {
  return "<component objectid=\"" + std::to_string(id) + "\" " + attributes + "/>";
}

std::string item(int id, const std::string& attributes = "") {
  return "<item objectid=\"" + std::to_string(id) + "\" " + attributes + "/>";
}

std::string model(const std::string& objects, const std::string& items,
                  const std::string& attributes = R"(unit="meter")") {
  return "<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" " +
         attributes + "><resources>" + objects + "</resources><build>" + items + "</build></model>";
}

ZippedFile main_model(const std::string& content) {
  return {"3D/3dmodel.model", content};
}

std::string package(const std::string& objects, const std::string& items,
                    const std::vector<ZippedFile>& others = {},
                    const std::string& attributes = R"(unit="meter")") {
  std::vector<ZippedFile> files = others;
  files.push_back(main_model(model(objects, items, attributes)));
  return zip(files);
}

std::string notes_of(const RawMesh& mesh) {
  std::string all;
  for (const std::string& note : mesh.notes) all += note + "\n";
  return all;
}

// Expects a solid of this volume, and a note of these words.
void expect_volume(const std::string& content, double volume, const std::string& note = "") {
  try {
    EXPECT_NEAR(solid_of(content, "a.3mf").facts.volume, volume, kExact);
    EXPECT_NE(notes_of(parse(content, "a.3mf")).find(note), std::string::npos)
        << notes_of(parse(content, "a.3mf"));
  } catch (const Error& fault) {
    ADD_FAILURE() << fault.what();
  }
}

void expect_refusal(const std::string& content, const std::string& words) {
  const std::string refusal = refusal_of(content, "a.3mf");
  EXPECT_NE(refusal.find(words), refusal.npos) << refusal;
  EXPECT_NE(refusal.find("a.3mf"), refusal.npos) << refusal;
}

TEST_F(Threemf, UnitsAreThoseOfTheModel) {
  const auto edge_in = [](const std::string& attributes) {
    const RawMesh mesh = parse(package(object(1, 1), item(1), {}, attributes), "a.3mf");
    return mesh.vertices.at(0).x / -.5;
  };
  EXPECT_NEAR(edge_in(""), .001, kExact);
  EXPECT_NEAR(edge_in(R"(unit="micron")"), 1e-6, kExact);
  EXPECT_NEAR(edge_in(R"(unit=" inch ")"), .0254, kExact);
  EXPECT_NEAR(edge_in(R"(unit="foot")"), .3048, kExact);
  expect_refusal(package(object(1, 1), item(1), {}, R"(unit="mile")"), "its unit 'mile' is none");
}

TEST_F(Threemf, WhatIsNoElementOfTheModelIsNone) {
  const std::string xml = model(object(1, 1), item(1));
  const std::string before = R"(<?xml version="1.0"?><!-- <model unit="inch"> -->)";
  expect_volume(zip({main_model(before + xml)}), 1);
  expect_volume(zip({main_model("\xEF\xBB\xBF" + xml)}), 1);
  std::string wide = "\xFF\xFE";  // UTF-16
  for (const char c : R"(<?xml version="1.0" encoding="UTF-16"?>)" + xml) wide += {c, '\0'};
  expect_volume(zip({main_model(wide)}), 1);
}

TEST_F(Threemf, TypesThatAreNoSolidAreLeftOut) {
  for (const std::string type : {"support", "solidsupport", "surface", "other"}) {
    const std::string second = object(2, 3, "type=\"" + type + "\"");
    const std::string note = "1 part is left out as no part of the solid: " + type;
    expect_volume(package(object(1, 1) + second, item(1) + item(2)), 1, note);
    const std::string both =
        object(3, "", "<components>" + component(1) + component(2) + "</components>");
    expect_volume(package(object(1, 1) + second + both, item(3)), 1, note);
    expect_refusal(package(second, item(2)), "its build places no mesh that is solid; " + note);
    // The type of an object of components says nothing.
    const std::string around =
        object(3, "type=\"" + type + "\"", "<components>" + component(1) + "</components>");
    expect_volume(package(object(1, 1) + around, item(3)), 1);
  }
  expect_volume(package(object(1, 1, R"(type="model")"), item(1)), 1);
}

TEST_F(Threemf, ObjectsThatTheBuildDoesNotPlaceAreNoPart) {
  expect_volume(package(object(1, 1) + object(2, 3), item(1)), 1);
  expect_refusal(package(object(1, 1), ""), "its build places no mesh that is solid");
  expect_volume(package(object(1, 1) + object(2, 3), item(1) + item(2, R"(printable="0")")), 1,
                "1 part is left out as no part of the solid: not printable");
}

TEST_F(Threemf, TransformsOfItemsAndComponentsAreApplied) {
  const std::string halved = R"(transform=".5 0 0 0 .5 0 0 0 .5 0 0 0")";
  const std::string beside = R"(transform="1 0 0 0 1 0 0 0 1 10 0 0")";
  const std::string pair =
      object(2, "", "<components>" + component(1) + component(1, beside) + "</components>");
  expect_volume(package(object(1, 1) + pair, item(2, halved)), 2 * .125);
  const CheckedSolid solid = solid_of(package(object(1, 1) + pair, item(2, halved)), "a.3mf");
  EXPECT_NEAR(solid.facts.high.x, 5.25, kExact);
  // Rows of the text are columns of the matrix: this turns x into y.
  const std::string turned = R"(transform="0 2 0 -1 0 0 0 0 1 0 0 0")";
  EXPECT_NEAR(solid_of(package(object(1, 1), item(1, turned)), "a.3mf").facts.high.y, 1, kExact);
  // A mirrored body beside a plain one: both are solid.
  const std::string mirrored = R"(transform="-1 0 0 0 1 0 0 0 1 4 0 0")";
  expect_volume(package(object(1, 1), item(1) + item(1, mirrored)), 2);
  for (const std::string bad : {"1 0 0", "1 0 0 0 1 0 0 0 1 0 0 x", "1 0 0 0 1 0 0 0 1 0 0 nan"})
    expect_refusal(package(object(1, 1), item(1, "transform=\"" + bad + "\"")),
                   "is not of 12 numbers");
}

TEST_F(Threemf, NodesHaveTheNamesOfObjects) {
  const std::string content =
      package(object(1, 1, R"(name="a &amp; b")") + object(2, 2, "", 10), item(1) + item(2));
  expect_volume(content, 9, "the meshes of 2 nodes are joined: a & b, object 2");
  const auto bytes = std::as_bytes(std::span(content));
  EXPECT_NEAR(parse_mesh(bytes, "a.3mf", "a & b").vertices.at(0).x, -.5, kExact);
  EXPECT_NEAR(parse_mesh(bytes, "a.3mf", "object 2").vertices.at(0).x, 9, kExact);
}

// Returns PrusaSlicer's settings of object 1, of 12 solid triangles and 12 that have this role.
ZippedFile prusa(const std::string& metadata) {
  return {
      "Metadata/Slic3r_PE_model.config",
      R"(<config><object id="1"><metadata type="object" key="name" value="x"/>)"
      R"(<volume firstid="0" lastid="11"><metadata type="volume" key="volume_type" value="ModelPart"/></volume>)"
      R"(<volume firstid="12" lastid="23">)" +
          metadata + "</volume></object></config>"};
}

std::string metadata(const std::string& key, const std::string& value) {
  return "<metadata type=\"volume\" key=\"" + key + "\" value=\"" + value + "\"/>";
}

std::string model_of_two_cubes(const std::string& of_mesh = "", double x = 0) {
  const auto small = cube(1), large = cube(3, x, 8);
  return object(1, "", mesh_of({small.first + large.first, small.second + large.second}, of_mesh));
}

TEST_F(Threemf, PrusaSlicersVolumesThatAreNoSolidAreLeftOut) {
  for (const std::string type : {"ParameterModifier", "SupportBlocker", "SupportEnforcer"}) {
    const std::string note = "1 part is left out as no part of the solid: " + type;
    const std::vector<ZippedFile> settings = {
        prusa(metadata("modifier", "1") + metadata("volume_type", type))};
    expect_volume(package(model_of_two_cubes(), item(1), settings), 1, note);
    EXPECT_EQ(
        solid_of(package(model_of_two_cubes(), item(1), settings), "a.3mf").facts.unused_vertices,
        0U);
  }
  expect_volume(package(model_of_two_cubes(), item(1), {prusa(metadata("modifier", "1"))}), 1,
                "modifier");
  expect_volume(
      package(model_of_two_cubes("", 10), item(1), {prusa(metadata("volume_type", "ModelPart"))}),
      28);
  expect_refusal(
      package(model_of_two_cubes(), item(1), {prusa(metadata("volume_type", "NegativeVolume"))}),
      "of the type NegativeVolume, which would have to be cut away");
  const std::string slic3r =
      R"(<slic3r:volumes xmlns:slic3r="x"><slic3r:volume ts="0" te="11" modifier="0"/>)"
      R"(<slic3r:volume ts="12" te="23" modifier="1"/></slic3r:volumes>)";
  expect_volume(package(model_of_two_cubes(slic3r), item(1)), 1, "modifier");
}

TEST_F(Threemf, BambusPartsThatAreNoSolidAreLeftOut) {
  const auto content = [](const std::string& subtype, const std::string& type) {
    const std::string both =
        object(3, "", "<components>" + component(1) + component(2) + "</components>");
    return package(
        object(1, 1) + object(2, 3, type) + both, item(3),
        {{"Metadata/model_settings.config",
          R"(<config><object id="3"><metadata key="name" value="x"/><part id="1" subtype="normal_part"/>)"
          R"(<part id="2" subtype=")" +
              subtype +
              R"("/></object><plate><metadata key="plater_id" value="1"/></plate></config>)"}});
  };
  for (const std::string type : {R"(type="other")", R"(type="model")"}) {
    for (const std::string subtype : {"modifier_part", "support_blocker", "support_enforcer"})
      expect_volume(content(subtype, type), 1,
                    "1 part is left out as no part of the solid: " + subtype);
    expect_refusal(content("negative_part", type),
                   "of the type negative_part, which would have to be cut away");
  }
}

TEST_F(Threemf, CurasMeshesThatAreNoSolidAreLeftOut) {
  for (const std::string key :
       {"support_mesh", "anti_overhang_mesh", "infill_mesh", "cutting_mesh"}) {
    const auto second = [&](const std::string& value) {
      return object(2, "",
                    "<metadatagroup><metadata name=\"cura:" + key +
                        "\" preserve=\"1\" type=\"xs:boolean\">" + value +
                        "</metadata></metadatagroup>" + mesh_of(cube(3, 10)));
    };
    expect_volume(package(object(1, 1) + second("True"), item(1) + item(2)), 1, key);
    expect_volume(package(object(1, 1) + second("False"), item(1) + item(2)), 28);
    const std::string old = object(2, "",
                                   "<settings xmlns=\"x\"><setting key=\"" + key +
                                       "\">True</setting></settings>" + mesh_of(cube(3, 10)));
    expect_volume(package(object(1, 1) + old, item(1) + item(2)), 1, key);
    const auto setting = [&](const std::string& value) {
      return "<metadatagroup><metadata name=\"cura:" + key + "\">" + value +
             "</metadata></metadatagroup>";
    };
    const std::string group =
        object(3, "", setting("True") + "<components>" + component(2) + "</components>");
    expect_volume(package(object(1, 1) + object(2, 3) + group, item(1) + item(3)), 1, key);
    const auto placed = [&](const std::string& value) {
      return package(object(1, 1) + object(2, 3, "", 10),
                     item(1) + "<item objectid=\"2\">" + setting(value) + "</item>");
    };
    expect_volume(placed("1"), 1, key);
    expect_volume(placed("0"), 28);
  }
  // What the package or a finished object tells is of no other.
  const std::string stray =
      "<metadatagroup><metadata name=\"cura:support_mesh\">True</metadata></metadatagroup>";
  expect_volume(package(object(1, 1) + stray, item(1) + stray), 1);
}

TEST_F(Threemf, PrusaSlicer3sVolumesThatAreNoSolidAreLeftOut) {
  const auto content = [](const std::string& project) {
    const auto holding = [](int id, int below) {
      return object(id, "", "<components>" + component(below) + "</components>");
    };
    const std::string both =
        object(5, "", "<components>" + component(3) + component(4) + "</components>");
    return package(object(1, 1) + object(2, 3, "", 10) + holding(3, 1) + holding(4, 2) + both,
                   item(5) + item(1, R"(transform="1 0 0 0 1 0 0 0 1 40 0 0")"),
                   {{"Metadata/PrusaSlicer3_project.json", project}});
  };
  const auto project = [](const std::string& type, const std::string& printable) {
    return R"({"objects":[{"id":5,"volumes":[{"id":3,"type":"ModelPart"},{"id":4,"type":")" + type +
           R"("}],"instances":[{"ord":0,"printable":true},{"ord":1,"printable":)" + printable +
           "}]}]}";
  };
  expect_volume(content(project("ModelPart", "true")), 29);
  for (const std::string type : {"ParameterModifier", "SupportEnforcer", "SupportBlocker"})
    expect_volume(content(project(type, "true")), 2, "left out as no part of the solid: " + type);
  expect_volume(content(project("ModelPart", "false")), 28, "solid: not printable");
  expect_refusal(content(project("NegativeVolume", "true")), "which would have to be cut away");
  expect_volume(content(R"({"objects":7})"), 29);
  for (const std::string& damaged :
       {std::string(R"({"objects")"), std::string(), std::string(10000, '[')})
    expect_refusal(content(damaged), "which tell what is solid, are damaged");
}

TEST_F(Threemf, SuperSlicersSettingsAreThoseOfPrusaSlicer) {
  ZippedFile settings = prusa(metadata("volume_type", "ParameterModifier"));
  settings.path = "Metadata/SuperSlicer_model.config";
  expect_volume(package(model_of_two_cubes(), item(1), {settings}), 1, "ParameterModifier");
}

TEST_F(Threemf, ObjectsOfOtherPartsOfThePackageAreRead) {
  const std::string production =
      R"(unit="meter" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="p")";
  const std::string path = R"(p:path="/3D/Objects/a.model")";
  const std::string around = object(2, "", "<components>" + component(1, path) + "</components>");
  const auto content = [&](const std::string& part) {
    return package(object(1, 2, "", 10) + around, item(1) + item(2), {{"3D/Objects/a.model", part}},
                   production);
  };
  expect_volume(content(model(object(1, 1), item(1))),
                9);  // the build of the other part counts nothing
  expect_volume(content(model(object(1, 1), "", "")), 9);
  expect_volume(
      package("", item(1, path), {{"3D/Objects/a.model", model(object(1, 1), "")}}, production), 1);
  expect_refusal(content(model(object(1, 1), "", R"(unit="inch")")),
                 "has another unit, inch, than its main model");
  expect_refusal(package(around, item(2), {}, production),
                 "model part '/3D/Objects/a.model' is not in the file");
  expect_refusal(package(around, item(2), {{"3D/Objects/a.model", "\x01\x02"}}, production),
                 "XML of its model is damaged");
  expect_refusal(content(model(object(7, 1), "")), "it has no object 1, which is placed");
}

TEST_F(Threemf, PartsThatAreEncryptedAreNamed) {
  const std::string path = R"(p:path="/3D/Secret.model")";
  const auto content = [&](const std::string& listed) {
    return package(object(1, 1), item(1) + item(2, path),
                   {{"3D/Secret.model", "\x01\x02\xFF"},
                    {"Secure/keystore.xml", "<keystore><resourcedatagroup><resourcedata path=\"" +
                                                listed + "\"/></resourcedatagroup></keystore>"}});
  };
  expect_refusal(content("/3D/Secret.model"), "its model part '/3D/Secret.model' is encrypted");
  expect_refusal(content("/3D/other.model"), "XML of its model is damaged");
}

TEST_F(Threemf, OtherPartsOfThePackageAreLeftAlone) {
  const std::string noise = std::string("\x89PNG\r\n\x1a\n", 8) + "<<<&\xFF";
  std::vector<ZippedFile> files;
  for (const std::string path :
       {"Metadata/thumbnail.png", "Metadata/Slic3r_PE.config", "Metadata/plate_1.gcode",
        "3D/_rels/3dmodel.model.rels", "2D/slices.model", "Metadata/custom_gcode_per_layer.xml",
        "Cura/preferences.cfg", "3D/Textures/a.png", "docProps/core.xml"})
    files.push_back({path, noise});
  expect_volume(package(object(1, 1), item(1), files), 1);
  files.push_back(
      {"_rels/.rels",
       R"(<Relationships><Relationship Target="/Metadata/thumbnail.png" Type="http://x/thumbnail"/>)"
       R"(<Relationship Target="/3D/part.model" Type="http://x/3dmodel"/></Relationships>)"});
  files.push_back({"3D/part.model", model(object(1, 2), item(1))});
  expect_volume(package(object(1, 1), item(1), files), 8);
  EXPECT_EQ(parse(zip(files), "a").format, MeshFormat::threemf);
  expect_refusal(zip({{"a.txt", "a"}}), "no 3D model is in it");
}

TEST_F(Threemf, SizesOfSixtyFourBitsAreRead) {
  expect_volume(zip({{"a.txt", "a"}, main_model(model(object(1, 1), item(1)))}, true), 1);
}

TEST_F(Threemf, WhatAnObjectHasBesideItsMeshIsSaid) {
  const std::string vendors = "<v:hint xmlns:v=\"urn:v\"><v:part/></v:hint>";
  expect_volume(package(object(1, "", mesh_of(cube(1)) + vendors), item(1)), 1,
                "an object has 'hint', which is not applied");
  expect_refusal(package(object(1, "", vendors), item(1)), "one of its objects is of 'hint'");
}

TEST_F(Threemf, ShapesThatAreNoMeshAreRefusedByName) {
  const std::string ball = R"(<bo:booleanshape objectid="1"/>)";
  expect_refusal(package(object(1, 1) + object(2, "", ball), item(2)),
                 "one of its objects is of 'booleanshape'");
  expect_refusal(package(object(1, "", mesh_of(cube(1), "<b:beamlattice/>")), item(1)),
                 "of a beam lattice");
  expect_refusal(package(object(1, 1, R"(s:slicestackid="2" s:meshresolution="lowres")"), item(1)),
                 "of another representation than its mesh");
  expect_refusal(package(object(1, 1), item(1), {},
                         R"(xmlns:v="http://x/volumetric/2022/01" requiredextensions="v")"),
                 "it requires the 3MF extension http://x/volumetric/2022/01");
  // Where the solid does not depend on them, nothing is lost.
  expect_volume(package(object(1, 1) + object(2, "", ball), item(1)), 1);
  expect_volume(package(object(1, 1, R"(s:slicestackid="2")"), item(1), {},
                        R"(unit="meter" xmlns:s="http://x/slice/2015/07" requiredextensions="s")"),
                1);
}

TEST_F(Threemf, DamageIsSaid) {
  const std::string whole = model(object(1, 1), item(1));
  expect_refusal(zip({main_model(whole.substr(0, whole.size() / 2))}),
                 "the XML of its model is damaged");
  expect_refusal(zip({main_model("<html/>")}), "begins with the element html, not model");
  std::string damaged = zip({main_model(whole)});
  damaged[damaged.find("vertex x=\"-0.5") + 10] = '1';  // the checksum tells
  expect_refusal(damaged, "cannot be unpacked");
  expect_refusal(
      package(object(1, 1), item(1), {{"Metadata/model_settings.config", "<config><obj"}}),
      "which tell what is solid, are damaged");
  const auto with_triangle = [](const std::string& triangle) {
    return package(object(1, "", mesh_of({cube(1).first, cube(1).second + triangle})), item(1));
  };
  expect_refusal(with_triangle(R"(<triangle v1="0" v2="1" v3="8"/>)"),
                 "a vertex index is out of range");
  expect_refusal(with_triangle(R"(<triangle v1="0" v2="1" v3="4294967296"/>)"),
                 "a vertex index is out of range");
  expect_refusal(with_triangle(R"(<triangle v1="0" v2="1"/>)"),
                 "the attribute v3 of a triangle is ''");
  expect_refusal(with_triangle(R"(<triangle v1="0" v2="1" v3="-1"/>)"),
                 "the attribute v3 of a triangle is '-1'");
  for (const std::string x : {"1,5", "nan", "", "inf"})
    EXPECT_NE(
        refusal_of(package(object(1, "", mesh_of({"<vertex x=\"" + x + R"(" y="0" z="0"/>)", ""})),
                           item(1)),
                   "a.3mf"),
        "")
        << x;
  expect_refusal(package(object(1, 1) + object(1, 1), item(1)), "two objects have the id 1");
}

TEST_F(Threemf, ComponentsWithoutEndAreRefused) {
  const std::string itself = object(1, "", "<components>" + component(1) + "</components>");
  expect_refusal(package(itself, item(1)), "nested without end");
  std::string objects = object(1, 1);  // each of two of the last: 2^40 in all
  for (int k = 2; k < 42; ++k)
    objects +=
        object(k, "", "<components>" + component(k - 1) + component(k - 1) + "</components>");
  expect_refusal(package(objects, item(41)),
                 "nested without end, or too often for a file of this size");
}

TEST_F(Threemf, WhatUnpacksToFarMoreIsRefused) {
  // A block that is flushed can be repeated: 10^9 blanks are packed by packing 10^6.
  std::string block(100'000, '\0');
  const std::string plain(1'000'000, ' ');
  z_stream stream{};
  ASSERT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(block.data());
  stream.avail_out = static_cast<uInt>(block.size());
  ASSERT_EQ(deflate(&stream, Z_FULL_FLUSH), Z_OK);
  ASSERT_EQ(stream.avail_in, 0U);
  block.resize(stream.total_out);
  deflateEnd(&stream);
  std::string packed;
  for (int k = 0; k < 1000; ++k) packed += block;
  std::string archive = zip({main_model(packed)});
  archive[archive.find("PK\x01\x02") + 10] = 8;  // the method: deflate
  expect_refusal(archive, "it unpacks to more than");
}

}  // namespace
}  // namespace vpm::test
