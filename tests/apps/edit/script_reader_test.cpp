// SPDX-License-Identifier: Apache-2.0
#include "apps/edit/script_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace script_reader_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// What is wrong with an order, or its place.
std::string wordsOf(const EditOrder& order) {
  return order.refusal ? std::string(order.refusal->what()) : order.where;
}

class Script : public testing::Test {
 protected:
  [[nodiscard]] std::string write(const std::string& text) const {
    std::ofstream(file_, std::ios::binary) << text;
    return file_;
  }
  [[nodiscard]] std::vector<std::string> ordersOf(const std::string& text) const {
    EditQueue queue(100);
    ScriptReader reader(write(text));
    EXPECT_EQ(reader.fraction(), 0);
    reader.giveTo(queue, [] { return false; });
    EXPECT_EQ(reader.fraction(), text.empty() ? 0 : 1);
    queue.close();
    std::vector<std::string> words;
    while (const auto order = queue.pop()) words.push_back(wordsOf(*order));
    return words;
  }
  TemporaryFolder folder_;
  std::string file_ = (folder_.path() / "a.txt").string();
};

TEST(EditOrderOfText, NamesItsPlaceAndText) {
  const EditOrder order = editOrder("undo", "--do");
  EXPECT_EQ(order.where, "--do 'undo'");
  EXPECT_EQ(order.text.verb, EditText::Verb::kUndo);
  EXPECT_FALSE(order.refusal);
  EXPECT_EQ(editOrder(std::string(120, 'a'), "x").where, "x '" + std::string(120, 'a') + "'");
  EXPECT_EQ(editOrder(std::string(121, 'a'), "x").where, "x '" + std::string(120, 'a') + "...'");
  EXPECT_TRUE(editOrder("a", "x").refusal);
}

TEST(EditOrderOfText, MeshesLieBesideTheScript) {
  const auto mesh = [](const char* text) { return editOrder(text, "x", "dir").text.mesh_file; };
  EXPECT_EQ(mesh("stamp-add:mesh=tet.obj:at=1,2,3"), "dir/tet.obj");
  EXPECT_EQ(mesh("stamp-add:mesh=/tet.obj:at=1,2,3"), "/tet.obj");
  EXPECT_EQ(mesh("undo"), "");
}

TEST(EditOrderOfText, IsRefusedWhereItIsNoText) {
  const auto refusal = [](std::string_view text) { return wordsOf(editOrder(text, "x")); };
  EXPECT_EQ(refusal("\x7f"),
            "x: it is no text: byte 1 is 0x7f; give commands as text, for example remove:radius=2mm:at=0,0,0");
  EXPECT_THAT(refusal("ab\x1f"), testing::StartsWith("x: it is no text: byte 3 is 0x1f; "));
  EXPECT_THAT(refusal(std::string_view("a\0", 2)), testing::StartsWith("x: it is no text: byte 2 is 0x00; "));
  for (const char* text : {"a b", "a\tb", "a\rb", "\xc3\xa9"}) {
    EXPECT_THAT(refusal(text), testing::Not(testing::HasSubstr("it is no text"))) << text;
  }
}

TEST_F(Script, CountsEveryLineAndSkipsWhatIsNoCommand) {
  EXPECT_THAT(ordersOf("\xEF\xBB\xBFundo\n\n# a comment\r\n  redo # again\r\n\xEF\xBB\xBFundo\nundo"),
              ElementsAre(file_ + " line 1 'undo'", file_ + " line 4 'redo'", testing::StartsWith(file_ + " line 5 '"),
                          file_ + " line 6 'undo'"));
  EXPECT_THAT(ordersOf(""), IsEmpty());
}

TEST_F(Script, TakesLinesOf8192Bytes) {
  const std::string longest = "undo" + std::string(kLongestLine - 4, ' ');
  EXPECT_THAT(
      ordersOf("redo\n" + longest + "\n" + longest + " \nundo\n" + longest + " "),
      ElementsAre(file_ + " line 1 'redo'", file_ + " line 2 'undo'",
                  file_ + " line 3: it has more than 8192 bytes; give one command a line", file_ + " line 4 'undo'",
                  file_ + " line 5: it has more than 8192 bytes; give one command a line"));
}

// More than one read takes: 20,000 lines of 5 bytes.
TEST_F(Script, MayBeLongerThanABuffer) {
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += "undo\n";
  ScriptReader reader(write(text));
  EditQueue queue(20'001);
  reader.giveTo(queue, [] { return false; });
  queue.close();
  std::size_t count = 0;
  std::string last;
  while (const auto order = queue.pop()) {
    ++count;
    last = order->where;
  }
  EXPECT_EQ(count, 20'000U);
  EXPECT_EQ(last, file_ + " line 20000 'undo'");
}

TEST_F(Script, IsGivenUpWhereNobodyWantsMore) {
  const std::string name = write("undo\nredo\n");
  EditQueue queue(10);
  ScriptReader(name).giveTo(queue, [] { return true; });
  queue.close();
  EXPECT_FALSE(queue.pop());
  ScriptReader reader(name);
  EditQueue abandoned(10);
  abandoned.abandon();
  reader.giveTo(abandoned, [] { return false; });
  EXPECT_EQ(reader.fraction(), 0);  // it was not even read
}

TEST_F(Script, ThatIsNotThereOrAFolderIsRefused) {
  const std::string none = (folder_.path() / "none").string();
  EXPECT_EQ(refusalOf([&] { ScriptReader reader(none); }, Error::Code::kNotFound),
            none + ": there is no such script; check its path and permissions, or give '-' for standard input");
  const std::string folder = folder_.path().string();
  EXPECT_EQ(refusalOf([&] { ScriptReader reader(folder); }),
            folder + ": it is a folder; give a file with one command a line");
}

}  // namespace script_reader_test
}  // namespace palpate
