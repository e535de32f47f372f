// The file of a checkpoint: what goes in comes out, and what was damaged is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include <fmt/format.h>

#include "halflight/base/hash.h"
#include "halflight/base/parallel.h"
#include "halflight/io/checkpoint_file.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

using ::testing::HasSubstr;

std::vector<float> numbers(std::size_t n) {
  std::vector<float> v(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = 3.f + to_unit_float(hash(i, 1));
  return v;
}

class CheckpointFile : public ::testing::Test {
 protected:
  Bytes bytes() const { return *read_file(path_); }
  void rewrite(const Bytes& b) const {
    folder_.write("file", {reinterpret_cast<const char*>(b.data()), b.size()});
  }
  std::string failure() const {
    const auto reader = SectionReader::open(path_);
    return reader ? "" : reader.error().line();
  }
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "file";
};

TEST_F(CheckpointFile, GivesBackWhatWasWritten) {
  const std::vector<std::size_t> sizes{0, 1, 5461, 5462, 16384, 200'000};
  SectionWriter writer;
  for (const std::size_t n : sizes) writer.add("floats " + std::to_string(n), numbers(n));
  // Items that do not divide a chunk.
  std::vector<std::array<float, 3>> triples(100'000);
  for (std::size_t i = 0; i < triples.size(); ++i)
    for (int k = 0; k < 3; ++k) triples[i][k] = to_unit_float(hash(i, k));
  writer.add("triples", triples);
  writer.add("words", std::string_view("a path"));
  ASSERT_TRUE(writer.write(path_));

  const auto reader = SectionReader::open(path_);
  ASSERT_TRUE(reader) << reader.error().line();
  for (const std::size_t n : sizes)
    EXPECT_EQ(*reader->array<float>("floats " + std::to_string(n)), numbers(n)) << n;
  EXPECT_EQ((*reader->array<std::array<float, 3>>("triples")), triples);
  EXPECT_EQ(*reader->text("words"), "a path");
  EXPECT_FALSE(reader->array<float>("no such array"));
  EXPECT_FALSE(reader->array<double>("floats 1"));
}

TEST_F(CheckpointFile, IsTheSameForAnyThreadCount) {
  std::vector<Bytes> files;
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    SectionWriter writer;
    writer.add("floats", numbers(300'000));
    ASSERT_TRUE(writer.write(path_));
    files.push_back(bytes());
  }
  set_thread_count(0);
  EXPECT_EQ(files[0], files[1]);
}

TEST_F(CheckpointFile, KnowsItsOwn) {
  SectionWriter writer;
  writer.add("floats", numbers(10));
  ASSERT_TRUE(writer.write(path_));
  EXPECT_TRUE(is_checkpoint(path_));
  EXPECT_FALSE(is_checkpoint(folder_.write("scene.obj", "v 0 0 0\n")));
  EXPECT_FALSE(is_checkpoint(folder_.write("empty", "")));
  EXPECT_FALSE(is_checkpoint(folder_.path() / "missing"));
  EXPECT_FALSE(is_checkpoint(folder_.path()));
}

TEST_F(CheckpointFile, SaysWhatIsWrong) {
  SectionWriter writer;
  writer.add("floats", numbers(10));
  ASSERT_TRUE(writer.write(path_));
  const Bytes whole = bytes();

  rewrite({});
  EXPECT_THAT(failure(), HasSubstr("not a checkpoint"));
  rewrite(Bytes(1000, 'x'));
  EXPECT_THAT(failure(), HasSubstr("not a checkpoint"));
  Bytes other = whole;
  other[kCheckpointMagic.size()] += 1;
  rewrite(other);
  EXPECT_THAT(failure(), HasSubstr(fmt::format("is of version {}", kCheckpointVersion + 1)));
  rewrite(Bytes(whole.begin(), whole.end() - 1));
  EXPECT_THAT(failure(), HasSubstr("cut short"));
  other = whole;
  other.back() ^= 1;
  rewrite(other);
  EXPECT_THAT(failure(), HasSubstr("damaged"));
  rewrite(whole);
  EXPECT_EQ(failure(), "");
}

// A few bytes for each chunk of 64 KiB would take gigabytes before they are looked at.
TEST_F(CheckpointFile, NothingButZerosIsRefusedForItsSize) {
  SectionWriter writer;
  writer.add("floats", std::vector<float>(20'000'000));
  ASSERT_TRUE(writer.write(path_));
  EXPECT_LT(bytes().size(), 300'000u);
  EXPECT_THAT(failure(), HasSubstr("damaged (at its lengths)"));
}

TEST_F(CheckpointFile, FlippedBitsAreNoticed) {
  SectionWriter writer;
  writer.add("floats", numbers(20));
  writer.add("words", std::string_view("a path"));
  ASSERT_TRUE(writer.write(path_));
  const Bytes whole = bytes();
  for (std::size_t i = 0; i < 8 * whole.size(); i += 5) {
    Bytes flipped = whole;
    flipped[i / 8] ^= static_cast<std::uint8_t>(1u << i % 8);
    rewrite(flipped);
    EXPECT_NE(failure(), "") << "bit " << i;
  }
}

}  // namespace
}  // namespace halflight
