// Changes what a section of a checkpoint holds and packs it again, so that checksums hold; now and
// then only bytes.
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "halflight/io/checkpoint_file.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using namespace halflight;

struct Section {
  std::string name;
  std::uint32_t item = 0;
};

// Names and sizes as the file has them; the reader has checked that it is sound.
std::vector<Section> sections_of(const Bytes& file) {
  constexpr std::size_t kHeader = 32;
  const auto number = [&]<class T>(std::size_t at, T) {
    T value{};
    std::memcpy(&value, file.data() + at, sizeof value);
    return value;
  };
  std::vector<Section> sections;
  for (std::size_t at = kHeader; at < file.size();) {
    const std::size_t length = file[at];
    Section section;
    section.name.assign(reinterpret_cast<const char*>(file.data()) + at + 1, length);
    at += 1 + length;
    section.item = number(at, std::uint32_t{});
    at += 4 + 8 + 8 + 8 + number(at + 4 + 8, std::uint64_t{});
    sections.push_back(std::move(section));
  }
  return sections;
}

// Calls body with an array of so many bytes.
template <class Body, std::size_t... n>
bool with_item(std::size_t size, const Body& body, std::index_sequence<n...>) {
  return ((size == n + 1 ? (body(std::array<std::uint8_t, n + 1>{}), true) : false) || ...);
}

template <class Item>
void mutate(std::vector<Item>& items, unsigned seed) {
  if (seed % 4 == 0 && !items.empty()) {
    items[seed / 4 % items.size()] = items[seed / 64 % items.size()];
    return;
  }
  const std::size_t size = items.size() * sizeof(Item);
  Bytes bytes(size + (seed % 4 == 1 ? 2 * sizeof(Item) : 0) + 1);
  if (size > 0) std::memcpy(bytes.data(), items.data(), size);
  const std::size_t changed =
      LLVMFuzzerMutate(bytes.data(), size, std::max<std::size_t>(bytes.size() - 1, 1));
  // Most arrays have a length that others know.
  const std::size_t kept = seed % 4 == 1 ? changed / sizeof(Item) : items.size();
  items.resize(kept);
  bytes.resize(kept * sizeof(Item));
  if (kept > 0) std::memcpy(items.data(), bytes.data(), bytes.size());
}

Bytes repacked(const SectionReader& reader, const std::vector<Section>& sections, unsigned seed) {
  SectionWriter writer;
  const std::size_t chosen = seed % sections.size();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const bool known = with_item(
        sections[i].item,
        [&](auto item) {
          auto items = reader.array<decltype(item)>(sections[i].name);
          if (!items) return;
          if (i == chosen) mutate(*items, seed / 64);
          writer.add(sections[i].name, *items);
        },
        std::make_index_sequence<32>());
    if (!known) return {};
  }
  return writer.bytes();
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  if (seed % 16 != 0) {
    const Bytes file(data, data + size);
    const auto reader = SectionReader::parse(file, "checkpoint");
    const auto sections = reader ? sections_of(file) : std::vector<Section>();
    const Bytes changed = sections.empty() ? Bytes() : repacked(*reader, sections, seed / 16);
    if (!changed.empty() && changed.size() <= most) {
      std::copy(changed.begin(), changed.end(), data);
      return changed.size();
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
