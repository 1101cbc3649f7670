#include <gmock/gmock.h>

#include "pipeline/param/param_table.h"
#include "pipeline/param/render.h"

namespace periost {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

enum class Method { kPaper, kCertified };
std::vector<Choice<Method>> choices_of(Method) {
  return {{Method::kPaper, "paper", "As published."},
          {Method::kCertified, "certified", "With certificates."}};
}

struct Keep {
  std::uint32_t count = 1;  // 0: all
  static std::optional<Keep> parse(std::string_view text) {
    if (text == "all") return Keep{0};
    if (text == "largest") return Keep{1};
    const auto number = parse_number(text);
    if (!number || *number < 1) return std::nullopt;
    return Keep{static_cast<std::uint32_t>(*number)};
  }
  std::string text() const { return count == 0 ? "all" : count == 1 ? "largest" : std::to_string(count); }
  static std::string form() { return "all | largest | N"; }
  friend bool operator==(const Keep&, const Keep&) = default;
};

struct Raw {
  std::array<std::int32_t, 3> dims{1, 2, 3};
  Vec3 spacing{1, 1, 0.5};
  friend bool operator==(const Raw&, const Raw&) = default;
};
void declare_params(ParamTable<Raw>& params) {
  params.param("dims", &Raw::dims, Quantity::kCount, Range::at_least(1), "Voxels along each axis.")
      .param("spacing", &Raw::spacing, Quantity::kLength, Range::above(0), "Sides of a voxel.");
}

struct Gate {
  std::optional<double> limit;
  std::optional<double> warn;
  friend bool operator==(const Gate&, const Gate&) = default;
};
void declare_params(ParamTable<Gate>& params) {
  params.param("limit", &Gate::limit, Quantity::kNumber, Range::any(), "Fails beyond it.")
      .param("warn", &Gate::warn, Quantity::kNumber, Range::any(), "Warns beyond it.");
}

struct Options {
  std::filesystem::path path;
  bool fill = false;
  int iterations = 10;
  std::uint64_t seed = 18446744073709551615ull;
  double lower = 226;
  float weight = 0.1f;
  std::string label = "010";
  Length distance = Length::voxel(0.3);
  Angle min_angle = Angle::deg(20);
  ByteSize memory{std::uint64_t{4} << 30};
  std::optional<double> timeout;
  std::vector<std::string> format{"abaqus"};
  Method method = Method::kCertified;
  Keep keep;
  Raw raw;
  std::map<std::string, Gate> gates{{"volume.min", Gate{8, std::nullopt}}};
  friend bool operator==(const Options&, const Options&) = default;
};

ParamTable<Options> table() {
  ParamTable<Options> params;
  params.param("path", &Options::path, Quantity::kNone, Range::required(), "The file.")
      .param("fill", &Options::fill, Quantity::kNone, Range::any(), "Fills it.")
      .param("iterations", &Options::iterations, Quantity::kCount, Range::between(0, 100), "How often.")
      .param("seed", &Options::seed, Quantity::kCount, Range::any(), "The seed.")
      .param("lower", &Options::lower, Quantity::kIntensity, Range::any(), "Lower bound.")
      .param("weight", &Options::weight, Quantity::kFraction, Range::fraction(), "A weight.")
      .param("label", &Options::label, Quantity::kNone, Range::any(), "A label.")
      .param("distance", &Options::distance, Quantity::kLength, Range::above(0), "Largest distance.")
      .param("min_angle", &Options::min_angle, Quantity::kAngle, Range::between(0, 60), "Smallest angle.")
      .param("memory", &Options::memory, Quantity::kBytes, Range::any(), "Memory.")
      .param("timeout", &Options::timeout, Quantity::kSeconds, Range::above(0), "Time.")
      .param("format", &Options::format, Quantity::kNone, Range::any(), "Formats.")
      .param("method", &Options::method, Quantity::kNone, Range::any(), "The method.")
      .param("keep", &Options::keep, Quantity::kNone, Range::any(), "What stays.")
      .param("raw", &Options::raw, Quantity::kNone, Range::any(), "Raw layout.")
      .param("gates", &Options::gates, Quantity::kNone, Range::any(), "Gates.");
  return params;
}

Value map_of(std::vector<std::pair<std::string, Value>> entries) {
  Value map = Value::map({});
  for (auto& [key, value] : entries) map.entries.push_back({key, {}, value});
  return map;
}
Value text(const std::string& text) {
  return Value::scalar(text);
}

// Decodes one key (and the required path).
std::pair<Options, Diagnostics> decode(const std::string& key, Value value) {
  Diagnostics diagnostics;
  Value map = map_of({{key, std::move(value)}});
  if (key != "path") map.entries.push_back({"path", {}, text("a")});
  const Options options = std::any_cast<Options>(table().decode(map, diagnostics));
  return {options, diagnostics};
}
std::string error_of(const std::string& key, Value value) {
  const auto [options, diagnostics] = decode(key, std::move(value));
  return diagnostics.empty() ? "" : format(diagnostics.front());
}

TEST(ParamTable, EncodingAndDecodingIsTheIdentity) {
  Options options;
  options.path = "a b/c.nii";
  options.lower = -0.1;
  options.weight = 0.3f;
  options.distance = Length::mm(1.0 / 3);
  options.timeout = 1e-7;
  options.raw.spacing = {0.1, 0.2, 0.7};
  options.keep.count = 5;
  for (const Options& x : {Options{}, options}) {
    Value map = table().encode(x);
    Diagnostics diagnostics;
    if (x.path.empty()) map.find("path");
    const auto y = std::any_cast<Options>(table().decode(map, diagnostics));
    for (const Diagnostic& d : diagnostics) EXPECT_EQ(d.code, "config.missing_key") << format(d);
    EXPECT_EQ(x, y);
  }
}

TEST(ParamTable, ReadsEveryForm) {
  EXPECT_EQ(decode("distance", text("0.45")).first.distance, Length::mm(0.45));
  EXPECT_EQ(decode("distance", text("0.3voxel")).first.distance, Length::voxel(0.3));
  EXPECT_EQ(decode("timeout", text("2 min")).first.timeout, 120);
  EXPECT_EQ(decode("timeout", Value{}).first.timeout, std::nullopt);
  EXPECT_EQ(decode("lower", text("226 HU")).first.lower, 226);
  EXPECT_THAT(decode("format", text("vtu")).first.format, ElementsAre("vtu"));
  EXPECT_THAT(decode("format", Value::list({text("vtu"), text("abaqus")})).first.format,
              ElementsAre("vtu", "abaqus"));
  EXPECT_EQ(decode("method", text("paper")).first.method, Method::kPaper);
  EXPECT_EQ(decode("keep", text("3")).first.keep.count, 3u);
  EXPECT_EQ(decode("iterations", text("1e2")).first.iterations, 100);
  EXPECT_EQ(decode("gates", map_of({{"x", map_of({{"warn", text("3")}})}})).first.gates.at("x").warn, 3);
  EXPECT_EQ(
      decode("raw", map_of({{"dims", Value::list({text("4"), text("5"), text("6")})}})).first.raw.dims[2], 6);
}

TEST(ParamTable, PathsStartAtTheFolder) {
  Diagnostics diagnostics;
  const Value map = map_of({{"path", text("../ct.nii")}});
  const auto options = std::any_cast<Options>(table().decode(map, diagnostics, "/data/configs"));
  EXPECT_EQ(options.path, "/data/ct.nii");
  EXPECT_EQ(table().encode(options, "/data/runs/x").find("path")->text, "../../ct.nii");
}

TEST(ParamTable, RefusesWithOneSentence) {
  EXPECT_EQ(error_of("distnce", text("1")),
            "error: unknown key 'distnce'; did you mean 'distance'? [config.unknown_key]");
  EXPECT_EQ(error_of("distance", text("0 mm")),
            "error: key 'distance': '0 mm' is out of range; it must be above 0 [config.out_of_range]");
  EXPECT_THAT(error_of("distance", text("3 kg")), HasSubstr("[config.wrong_unit]"));
  EXPECT_THAT(error_of("distance", text("far")), HasSubstr("'far' is not a length"));
  EXPECT_THAT(error_of("memory", text("500")), HasSubstr("has no unit"));
  EXPECT_THAT(error_of("iterations", text("1.5")), HasSubstr("'1.5' is not a whole number"));
  EXPECT_THAT(error_of("iterations", text("101")), HasSubstr("it must be from 0 to 100"));
  EXPECT_THAT(error_of("iterations", text("010")), HasSubstr("[config.wrong_type]"));
  EXPECT_THAT(error_of("seed", text("-1")), HasSubstr("[config.out_of_range]"));
  EXPECT_THAT(error_of("lower", text("007")), HasSubstr("'007' is not a number"));
  EXPECT_THAT(error_of("lower", text("nan")), HasSubstr("is not a number"));
  EXPECT_THAT(error_of("weight", text("0.5 mm")), HasSubstr("without a unit"));
  EXPECT_THAT(error_of("fill", text("yes")), HasSubstr("write true or false"));
  EXPECT_THAT(error_of("method", text("papr")), HasSubstr("did you mean 'paper'?"));
  EXPECT_THAT(error_of("keep", text("few")), HasSubstr("of the form all | largest | N"));
  EXPECT_THAT(error_of("raw", text("3")), HasSubstr("is not a map"));
  EXPECT_THAT(error_of("raw", map_of({{"dim", text("3")}})), HasSubstr("unknown key 'raw.dim'"));
  EXPECT_THAT(error_of("raw", map_of({{"dims", Value::list({text("4")})}})),
              HasSubstr("a list of 1 is not a list of 3"));
  EXPECT_THAT(error_of("raw", map_of({{"dims", Value::list({text("4"), text("0"), text("1")})}})),
              HasSubstr("key 'raw.dims[1]'"));
  Value quoted = text("3");
  quoted.is_quoted = true;
  EXPECT_THAT(error_of("lower", quoted), HasSubstr("is not a number"));
}

TEST(ParamTable, CollectsAllErrors) {
  Diagnostics diagnostics;
  table().decode(map_of({{"fil", text("x")}, {"lower", text("y")}}), diagnostics);
  ASSERT_EQ(diagnostics.size(), 3u);  // two keys and the missing path
}

TEST(ParamTable, RendersEveryKey) {
  for (const std::string& rendered : {help_text(table().params()), markdown_table(table().params()),
                                      json_schema(table().params()), json_list(table().params())}) {
    for (const char* name : {"path", "distance", "dims", "warn", "certified", "0.3 voxel"}) {
      EXPECT_THAT(rendered, HasSubstr(name));
    }
  }
}

}  // namespace
}  // namespace periost
