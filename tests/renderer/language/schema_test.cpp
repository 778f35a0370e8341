#include "renderer/language/schema.h"

#include "messages.h"
#include "renderer/language/json_writer.h"
#include "sample_catalogue.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace meristem {
namespace {

using namespace testing;

Value sample_schema() {
  Diagnostics diagnostics;
  Value schema = read_jsonc(source_of(json_schema(sample_catalogue())), diagnostics);
  EXPECT_EQ(messages_of(diagnostics), "");
  return schema;
}

// The value at a path of keys, as JSON; empty if there is none.
std::string at(const Value& root, std::initializer_list<const char*> path) {
  const Value* v = &root;
  for (const char* key : path)
    if (v) v = v->find(key);
  return v ? to_json(*v) : "";
}

void collect_references(const Value& v, std::set<std::string>& references) {
  for (const Value& item : v.items) collect_references(item, references);
  for (const Member& member : v.members) {
    if (member.key == "$ref") references.insert(member.value.text);
    collect_references(member.value, references);
  }
}

TEST(Schema, IsDraft7AndClosed) {
  const Value schema = sample_schema();
  EXPECT_EQ(at(schema, {"$schema"}), "\"http://json-schema.org/draft-07/schema#\"");
  EXPECT_EQ(at(schema, {"additionalProperties"}), "false");
  for (const char* section :
       {"format", "include", "materials", "models", "objects", "lights", "camera", "cameras", "render"})
    EXPECT_NE(at(schema, {"properties", section, "description"}), "") << section;
}

TEST(Schema, EveryReferenceHasItsDefinition) {
  const Value schema = sample_schema();
  std::set<std::string> references;
  collect_references(schema, references);
  EXPECT_GT(references.size(), 10u);
  const std::string prefix = "#/definitions/";
  for (const std::string& reference : references) {
    ASSERT_TRUE(reference.starts_with(prefix)) << reference;
    EXPECT_NE(at(schema, {"definitions", reference.substr(prefix.size()).c_str()}), "") << reference;
  }
}

TEST(Schema, NothingStandsBesideAReference) {
  // Draft 7 would ignore it
  const std::function<void(const Value&)> check = [&](const Value& v) {
    EXPECT_TRUE(!v.find("$ref") || v.members.size() == 1) << to_json(v);
    for (const Value& item : v.items) check(item);
    for (const Member& member : v.members) check(member.value);
  };
  check(sample_schema());
}

TEST(Schema, ShowsTypeRangeUnitDefaultAndMeaning) {
  const Value schema = sample_schema();
  const auto sky = [&](const char* name) { return at(schema, {"definitions", "light.sky", "properties", name}); };
  EXPECT_EQ(at(schema, {"definitions", "light.sky", "properties", "elevation", "minimum"}), "0");
  EXPECT_EQ(at(schema, {"definitions", "light.sky", "properties", "elevation", "maximum"}), "90");
  EXPECT_EQ(at(schema, {"definitions", "light.sky", "properties", "elevation", "default"}), "40");
  EXPECT_EQ(at(schema, {"definitions", "light.sky", "properties", "elevation", "description"}),
            "\"height of the sun above the horizon (deg)\"");
  EXPECT_EQ(sky("sun"),
            R"({ "type": "boolean", "description": "whether the disc of the sun shines as well", "default": true })");
  EXPECT_EQ(sky("model"),
            R"({ "enum": ["hosek", "preetham"], "description": "which fit to measured skies", "default": "hosek" })");
  EXPECT_EQ(sky("type"), "{ \"const\": \"sky\" }");
  EXPECT_EQ(at(schema, {"definitions", "light.sky", "additionalProperties"}), "false");
  EXPECT_EQ(at(schema, {"definitions", "light.rectangle", "required"}), R"(["corner", "radiance"])");
}

TEST(Schema, WhatMayDependOnTimeMayBeAText) {
  const Value schema = sample_schema();
  const auto pinhole = [&](const char* name) {
    return at(schema, {"definitions", "camera.pinhole", "properties", name, "anyOf"});
  };
  EXPECT_EQ(pinhole("fov"), R"([{ "type": "string" }, { "type": "number", "minimum": 1, "maximum": 170 }])");
  const Value* const from =
      schema.find("definitions")->find("camera.pinhole")->find("properties")->find("from")->find("anyOf");
  ASSERT_EQ(from->items.size(), 2u);
  EXPECT_EQ(at(from->items[0], {"type"}), "\"string\"");
  EXPECT_EQ(at(from->items[1], {"items"}), R"({ "anyOf": [{ "type": "string" }, { "type": "number" }] })");
}

TEST(Schema, AsksForTheTypeUnlessOneIsTheDefault) {
  const Value schema = sample_schema();
  EXPECT_EQ(at(schema, {"definitions", "light", "required"}), R"(["type"])");
  EXPECT_EQ(at(schema, {"definitions", "camera", "required"}), "");
  const Value* const branches = schema.find("definitions")->find("camera")->find("allOf");
  EXPECT_EQ(at(branches->items[0], {"if", "required"}), "");  // the pinhole, also without a type
  EXPECT_EQ(at(branches->items[1], {"if", "required"}), R"(["type"])");
}

TEST(Schema, TellsStepsApartByTheirKeys) {
  const Value schema = sample_schema();
  EXPECT_EQ(at(schema, {"definitions", "step", "anyOf"}),
            R"([{ "required": ["subdivide"] }, { "required": ["grow"] }])");
  const Value* const branches = schema.find("definitions")->find("step")->find("allOf");
  EXPECT_EQ(at(branches->items[1], {"if", "required"}), R"(["grow"])");
  EXPECT_EQ(at(branches->items[1], {"then", "$ref"}), "\"#/definitions/step.grow\"");
  EXPECT_EQ(at(schema, {"definitions", "step.subdivide", "required"}), R"(["subdivide"])");
  EXPECT_EQ(at(schema, {"definitions", "step.grow", "required"}), R"(["rules", "grow"])");
}

TEST(Schema, LeavesProductionsOpenForTheirTemplates) {
  const Value schema = sample_schema();
  EXPECT_EQ(at(schema, {"definitions", "template.segment", "additionalProperties"}), "");
  EXPECT_EQ(at(schema, {"definitions", "template.segment", "properties", "template"}), "{ \"const\": \"segment\" }");
  EXPECT_EQ(schema.find("definitions")->find("production")->find("allOf")->items.size(), 2u);
}

TEST(Schema, IsCompleteForAnEmptyCatalogue) {
  EXPECT_NE(json_schema(Catalogue{}).find("\"definitions\""), std::string::npos);
}

}  // namespace
}  // namespace meristem
