// One way to store each kind of field of a solve in a checkpoint, and to read it back: nothing that
// no solve can have written gets past the reader.
#pragma once

#include <atomic>
#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "halflight/base/parallel.h"
#include "halflight/io/checkpoint_file.h"
#include "halflight/solve/state_fields.h"

namespace halflight {

// Whether what was read could be of a state over this tree.
class Judge {
 public:
  Judge(const ElementTree& tree, const Range& range) : tree_(tree), range_(range) {}

  // Not what is no number.
  bool operator()(float v) const { return is_within(range_, v); }
  bool operator()(const Rgb& v) const { return (*this)(v.r) && (*this)(v.g) && (*this)(v.b); }
  template <std::integral Number>
  bool operator()(Number v) const {
    return is_within(range_, v);
  }
  bool operator()(Stage v) const { return v <= Stage::done; }
  bool operator()(MaterialId) const { return true; }  // judged by the scene
  bool operator()(LightId) const { return true; }
  bool operator()(ElementId e) const { return e.value < tree_.size(); }
  bool operator()(const ElementPair& p) const { return (*this)(p.receiver) && (*this)(p.source); }
  bool operator()(const Link& l) const {
    return (*this)(l.source) && is_within(kWeight, l.error) &&
           (is_within(kWeight, l.weight) || l.weight == Link::kUnsampled);
  }
  template <class T>
  bool operator()(const std::vector<T>& items) const {
    std::atomic<bool> sound{true};
    parallel_for(items.size(), 4096, [&](std::size_t i) {
      if (!(*this)(items[i])) sound.store(false, std::memory_order_relaxed);
    });
    return sound;
  }

 private:
  template <class Number>
  static bool is_within(const Range& range, Number v) {
    const auto value = static_cast<double>(v);
    return value >= range.least && value <= range.most;
  }

  const ElementTree& tree_;
  Range range_;
};

inline std::string counts_of(std::string_view links) { return fmt::format("{} of each", links); }

class FieldWriter {
 public:
  FieldWriter(SectionWriter& file, const ElementTree& tree) : file_(file), tree_(tree) {}

  template <class T>
  void operator()(std::string_view name, const T& value, const Range& = {}) const {
    file_.add_value(name, value);
  }
  template <class T>
  void operator()(std::string_view name, const std::vector<T>& items, const Range& = {}) const {
    file_.add(name, items);
  }
  template <class T>
  void operator()(std::string_view name, const IdVector<ElementId, T>& items,
                  const Range& = {}) const {
    file_.add(name, items.raw());
  }
  void operator()(std::string_view name, const LinkTable& table) const {
    std::vector<std::uint32_t> counts(tree_.size());
    std::vector<Link> links;
    links.reserve(table.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto row = table.of(ElementId(i));
      counts[i] = static_cast<std::uint32_t>(row.size());
      links.insert(links.end(), row.begin(), row.end());
    }
    file_.add(counts_of(name), counts);
    file_.add(name, links);
  }

 private:
  SectionWriter& file_;
  const ElementTree& tree_;
};

// The same fields back again; stops at the first that is wrong.
class FieldReader {
 public:
  FieldReader(const SectionReader& file, const ElementTree& tree) : file_(file), tree_(tree) {}

  Result<void> result() const { return done_; }

  template <class T>
  void operator()(std::string_view name, T& value, const Range& range = {}) const {
    const auto items = read<T>(name, range);
    if (!done_) return;
    if (items.size() == 1)
      value = items.front();
    else
      done_ = file_.damaged(name);
  }
  template <class T>
  void operator()(std::string_view name, std::vector<T>& items, const Range& range = {}) const {
    items = read<T>(name, range);
  }
  template <class T>
  void operator()(std::string_view name, IdVector<ElementId, T>& items,
                  const Range& range = {}) const {
    auto values = read<T>(name, range);
    if (!done_) return;
    const bool none = items.empty() && values.empty();
    if (values.size() == tree_.size() || none)
      items.raw() = std::move(values);
    else
      done_ = file_.damaged(name);
  }
  void operator()(std::string_view name, LinkTable& table) const {
    const auto counts = read<std::uint32_t>(counts_of(name), kCount);
    auto links = read<Link>(name);
    if (!done_) return;
    std::uint64_t total = 0;
    for (const std::uint32_t n : counts) total += n;
    if (counts.size() == tree_.size() && total == links.size())
      table = LinkTable(counts, std::move(links));
    else
      done_ = file_.damaged(name);
  }

 private:
  template <class T>
  std::vector<T> read(std::string_view name, const Range& range = {}) const {
    if (!done_) return {};
    auto items = file_.array<T>(name);
    if (!items)
      done_ = tl::unexpected(items.error());
    else if (!Judge(tree_, range)(*items))
      done_ = file_.damaged(name);
    return done_ ? std::move(*items) : std::vector<T>();
  }

  const SectionReader& file_;
  const ElementTree& tree_;
  mutable Result<void> done_;
};

}  // namespace halflight
