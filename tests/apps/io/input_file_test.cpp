#include "apps/io/input_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/io/source_excerpt.h"

namespace grainlaw::io {
namespace {

std::string problems_of(InputFile& in) {
  try {
    in.finish();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(InputFile, AWholeNumberIsANumberButANumberIsNoWholeNumber) {
  InputFile in = InputFile::from_text("a = 5\nb = 5.0\n", "f");
  EXPECT_EQ(in.top().read<double>({"a", ""}), 5.0);
  in.top().read<std::int64_t>({"b", ""});
  EXPECT_NE(problems_of(in).find("f:2:5: error: 'b' must be an integer, found a number"),
            std::string::npos);
}

TEST(InputFile, ValuesAreDividedByTheUnitAndCheckedBeforeThat) {
  InputFile in = InputFile::from_text("a = 3.0\nb = [2.0, 4.0]\n", "f");
  EXPECT_EQ(in.top().read<double>({"a", "", {"mm", 2.0}, from_to(3.0, 3.0)}), 1.5);
  EXPECT_EQ(in.top().read<std::vector<double>>({"b", "", {"mm", 2.0}}), (std::vector{1.0, 2.0}));
  EXPECT_EQ(problems_of(in), "");
}

TEST(InputFile, NotANumberIsNeverInRangeAndInfinityOnlyWhenAllowed) {
  InputFile in = InputFile::from_text("a = nan\nb = inf\nc = inf\n", "f");
  in.top().read<double>({"a", ""});
  in.top().read<double>({"b", ""});
  EXPECT_EQ(in.top().read<double>({"c", "", {}, positive_or_infinite}), INFINITY);
  const std::string text = problems_of(in);
  EXPECT_NE(text.find("a = nan is out of range"), std::string::npos);
  EXPECT_NE(text.find("b = inf is out of range: it has to be finite"), std::string::npos);
  EXPECT_EQ(text.find("c = inf"), std::string::npos);
}

TEST(InputFile, AWrongValueIsTheOnlyProblemOfItsKey) {
  InputFile in = InputFile::from_text("a = [1, -2]\nb = []\n", "f");
  Section top = in.top();
  for (const std::string_view key : {"a", "b"}) {
    const auto list = top.find<std::vector<double>>({key, "", {}, positive});
    if (list.value_or(std::vector<double>{}).empty()) top.problem(key, "is empty");
  }
  const std::string text = problems_of(in);
  EXPECT_NE(text.find("f:1:9: error: a = -2 is out of range"), std::string::npos) << text;
  EXPECT_EQ(text.find("f:1:1: error: is empty"), std::string::npos) << text;
  EXPECT_NE(text.find("f:2:1: error: is empty"), std::string::npos) << text;
}

TEST(InputFile, ABinaryFileIsCalledWhatItIs) {
  const auto message = [](const std::string& bytes) -> std::string {
    try {
      InputFile::from_text(bytes, "run.h5");
    } catch (const ReadError& error) {
      return error.what();
    }
    return "";
  };
  for (const std::size_t user_block : {0u, 512u, 4096u}) {
    EXPECT_EQ(message(std::string(user_block, 'u') + "\x89HDF\r\n\x1a\n..."),
              "run.h5:1:1: error: this is an HDF5 file, e.g. a run; a TOML file is expected");
  }
  EXPECT_EQ(message(std::string("PK\0\1", 4)),
            "run.h5:1:1: error: this is a binary file; a TOML file is expected");
}

TEST(InputFile, ColumnsCountCharactersNotBytes) {
  const std::string text = "a = \"\u00e4\u00f6\" x\n";
  EXPECT_EQ(excerpt("f", text, {1, 10, 1}, "here"),
            "f:1:10: error: here\n    1 | a = \"\u00e4\u00f6\" x\n      |          ^");
}

TEST(InputFile, LongLinesAreCutAroundThePlace) {
  const std::string line(5000, 'a');
  const std::string shown = excerpt("f", line, {1, 3000, 1}, "here");
  EXPECT_LT(shown.size(), 400u);
}

TEST(InputFile, TheNearestWordIsFoundUpToAThirdOfItsLetters) {
  EXPECT_EQ(edit_distance("stifness", "stiffness"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(nearest("inclinaton", {"inclination", "length"}), "inclination");
  EXPECT_EQ(nearest("colour", {"inclination", "length"}), "");
}

TEST(InputFile, ListingReadsNothingAndComplainsAboutNothing) {
  InputFile in = InputFile::listing();
  Section section = in.section("s", "Meaning");
  section.read<double>({"k", "what it is", {"mass"}, positive});
  EXPECT_EQ(in.key_list(),
            "### `[s]`\n\nMeaning.\n\n"
            "| key | type | unit | range | if missing | meaning |\n|---|---|---|---|---|---|\n"
            "| `k` | number | mass | 0 < x | required | what it is |\n\n");
}

}  // namespace
}  // namespace grainlaw::io
