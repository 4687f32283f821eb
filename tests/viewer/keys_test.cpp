#include "viewer/keys.h"

#include <gtest/gtest.h>

#include <set>

#include "image/test_files.h"
#include "tests/temporary_folder.h"
#include "viewer/script.h"
#include "xrds/error.h"

namespace xrds::test {
namespace {

TEST(Keys, HaveOneMeaningEachAndAHelp) {
  std::set<std::pair<int, int>> seen;
  for (const KeyBinding& binding : keyBindings()) {
    EXPECT_FALSE(std::string(binding.keys).empty());
    EXPECT_FALSE(std::string(binding.text).empty()) << binding.keys;
    EXPECT_FALSE(binding.meanings.empty()) << binding.keys;
    for (const KeyMeaning& meaning : binding.meanings)
      EXPECT_TRUE(seen.insert({meaning.key, meaning.modifiers}).second) << binding.keys << " has two meanings";
  }
}

TEST(Keys, AreReadAsScriptsWriteThem) {
  const auto meaning = [](const char* text) {
    const auto press = parseKey(text);
    return press ? commandOf(press->key, press->modifiers) : std::nullopt;
  };
  EXPECT_EQ(meaning("W")->command, Command::wipe);
  EXPECT_EQ(meaning("Ctrl+S")->command, Command::save);
  EXPECT_EQ(meaning("S")->command, Command::screenshot);
  EXPECT_EQ(meaning("1")->digit, 0);
  EXPECT_EQ(meaning("9")->digit, 8);
  EXPECT_EQ(meaning("0")->digit, 9);
  EXPECT_EQ(meaning("K")->command, Command::skip);
  EXPECT_EQ(meaning("Shift+3")->command, Command::showLeft);
  EXPECT_EQ(meaning("Shift+3")->digit, 2);
  EXPECT_EQ(meaning("PageDown")->command, Command::nextFrame);
  EXPECT_FALSE(meaning("Ctrl+W"));
  EXPECT_FALSE(parseKey("Hyper"));
  EXPECT_FALSE(parseKey("w"));
}

TEST(Script, WaitsUntilItIsReady) {
  std::string log;
  const auto note = [&log](const std::vector<std::string>& words) { log += words.empty() ? "." : words[0]; };
  Script script({{1, "say", {"a"}}, {2, "!say", {"b"}}, {3, "say", {"c"}}}, {{"say", "WORD", ""}}, {{"say", note}});
  script.step(false);
  EXPECT_EQ(log, "");
  script.step(true);
  script.step(false);  // hasty
  EXPECT_EQ(log, "ab");
  script.step(false);
  EXPECT_EQ(log, "ab");
  EXPECT_FALSE(script.finished());
  script.step(true);
  EXPECT_EQ(log, "abc");
  EXPECT_TRUE(script.finished());
}

TEST(Script, RefusesWhatItCannotDo) {
  const auto refused = [](ScriptLine line) {
    EXPECT_THROW(Script({line}, {{"say", "WORD", ""}}, {{"say", [](const auto&) {}}}), Error) << line.verb;
  };
  refused({1, "sing", {"a"}});
  refused({1, "say", {}});
  refused({1, "say", {"a", "b"}});
  EXPECT_THROW(readScript("none.txt"), Error);
  const TemporaryFolder folder;
  writeBytes(folder / "s.txt", "# a comment\n\nkey W  # another\nwait\n");
  const auto lines = readScript(folder / "s.txt");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_EQ(lines[0].arguments, std::vector<std::string>{"W"});
}

TEST(Script, TakesAsManyArgumentsAsItsTableNames) {
  EXPECT_EQ((ScriptVerb{"wait", "", ""}.argumentCount()), 0);
  EXPECT_EQ((ScriptVerb{"move", "X Y", ""}.argumentCount()), 2);
  EXPECT_EQ((ScriptVerb{"drop", "FILE ...", ""}.argumentCount()), -1);
  // A step of the table that does nothing is our mistake.
  EXPECT_THROW(Script({}, {{"say", "", ""}}, {}), std::logic_error);
}

TEST(Script, WaitsForNothingWhereTheTableSaysSo) {
  std::string log;
  const auto note = [&log](const std::vector<std::string>&) { log += "."; };
  Script script({{1, "go", {}}}, {{"go", "", "", true}}, {{"go", note}});
  EXPECT_EQ(script.patience(false), 0);
  script.step(false);
  EXPECT_EQ(log, ".");
}

TEST(Script, HasAHelpThatNamesEveryStepOnce) {
  const std::string help = scriptHelp();
  std::set<std::string> seen;
  for (const ScriptVerb& verb : scriptVerbs()) {
    EXPECT_TRUE(seen.insert(verb.word).second) << verb.word;
    EXPECT_FALSE(std::string(verb.text).empty()) << verb.word;
    const std::string written = std::string("\n  ") + verb.word + " " + verb.arguments;
    EXPECT_NE(help.find(written), std::string::npos) << verb.word;
  }
}

}  // namespace
}  // namespace xrds::test
