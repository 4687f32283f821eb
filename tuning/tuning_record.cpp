#include "tuning/tuning_record.h"

#include <charconv>
#include <concepts>
#include <cstdio>
#include <locale>
#include <mutex>
#include <sstream>

#include "engine/bytes.h"
#include "engine/cache_file.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr std::string_view kFirstLine = "xrds tuning 2";

/// The fields of a line, separated by tabs, read one by one. Throws Error at what is no such field.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) {}
  std::string text() {
    if (ended_) throw Error("A field is missing.");
    const size_t end = rest_.find('\t');
    std::string field(rest_.substr(0, end));
    ended_ = end == std::string_view::npos;
    rest_.remove_prefix(ended_ ? rest_.size() : end + 1);
    return field;
  }
  template <std::integral T>
  T number() {
    const std::string field = text();
    T value{};
    const auto [end, failed] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (failed != std::errc() || end != field.data() + field.size()) throw Error("A number is none.");
    return value;
  }
  // By a stream: libc++ before version 20 has no std::from_chars() for fractions, and the program's locale is none of
  // the record's.
  double fraction() {
    std::istringstream stream(text());
    stream.imbue(std::locale::classic());
    double value = 0;
    if (!(stream >> std::noskipws >> value) || stream.peek() != std::istringstream::traits_type::eof())
      throw Error("A number is none.");
    return value;
  }
  TrialKey key() { return {number<uint32_t>(), text()}; }
  ProgramStamp program() { return {text(), number<uint64_t>()}; }
  KernelChoice kernel() {
    KernelChoice kernel{kernelFamilyOf(text())};
    kernel.shape = {number<uint32_t>(), number<uint32_t>(), number<uint32_t>()};
    return kernel;
  }
  std::optional<bool> flag() {
    const int number = this->number<int>();
    return number < 0 ? std::nullopt : std::optional(number != 0);
  }

 private:
  std::string_view rest_;
  bool ended_ = false;
};

class Line {
 public:
  explicit Line(const char* kind) : text_(kind) {}
  Line& operator<<(const std::string& field) {
    text_ += '\t';
    for (const char c : field) text_ += c == '\t' || c == '\n' ? ' ' : c;
    return *this;
  }
  Line& operator<<(uint64_t number) { return *this << std::to_string(number); }
  Line& operator<<(double number) {
    std::ostringstream digits;
    digits.imbue(std::locale::classic());
    digits << number;
    return *this << digits.str();
  }
  Line& operator<<(const TrialKey& key) { return *this << uint64_t{key.size} << key.shape; }
  Line& operator<<(const ProgramStamp& program) { return *this << program.name << program.hash; }
  Line& operator<<(const KernelChoice& kernel) {
    return *this << std::string(nameOf(kernel.family)) << uint64_t{kernel.shape.outputs} << uint64_t{kernel.shape.rows}
                 << uint64_t{kernel.shape.subgroup};
  }
  Line& operator<<(const std::optional<bool>& flag) { return *this << std::to_string(flag ? int{*flag} : -1); }
  std::string str() const { return text_ + "\n"; }

 private:
  std::string text_;
};

void readLine(std::string_view line, TuningRecord& record) {
  Fields fields(line);
  const std::string kind = fields.text();
  if (kind == "finding") {
    const TrialKey key = fields.key();
    const KernelChoice kernel = fields.kernel();
    Finding found{.program = fields.program()};
    found.right = fields.number<int>() != 0;
    found.microseconds = fields.fraction();
    found.why = fields.text();
    record.findings[{key, kernel}] = found;
  } else if (kind == "winner") {
    const TrialKey key = fields.key();
    Winner winner{.kernel = fields.kernel()};
    winner.program = fields.program();
    winner.fixedProgram = fields.program();
    winner.microseconds = fields.fraction();
    winner.fixedMicroseconds = fields.fraction();
    winner.isFixed = fields.number<int>() != 0;
    record.winners[key] = winner;
  } else if (kind == "struck off") {
    const ProgramStamp program = fields.program();
    record.struckOff[program.name] = {program.hash, fields.text()};
  } else if (kind == "frame") {
    const std::string name = fields.text();
    TunedFrame frame{.taken = fields.number<int>() != 0};
    frame.normsInLinear = fields.flag();
    frame.layersFused = fields.flag();
    frame.seconds = fields.fraction();
    frame.fixedSeconds = fields.fraction();
    frame.tuningSeconds = fields.fraction();
    frame.date = fields.number<int64_t>();
    frame.label = fields.text();
    record.frames[name] = frame;
  } else if (kind == "trying" || kind == "trying the fixed choice") {
    record.trying = fields.program();
    record.isFixedTried = kind != "trying";
  } else if (kind == "suspect") {
    const ProgramStamp program = fields.program();
    record.suspects[program.name] = program.hash;
  } else {
    throw Error("There is no such line.");
  }
}

/// Records that could not be written, by file and driver.
struct Unwritten {
  static Unwritten& ofProcess() {
    static Unwritten records;
    return records;
  }
  std::mutex access;
  std::map<std::pair<std::filesystem::path, std::string>, TuningRecord> records;
};

}  // namespace

void TuningRecord::takeStock() {
  if (!trying) return;
  const auto suspect = suspects.find(trying->name);
  const bool isFirst = suspect == suspects.end() || suspect->second != trying->hash;
  if (isFixedTried && isFirst)
    suspects[trying->name] = trying->hash;
  else
    struckOff[trying->name] = {trying->hash, "the process ended while it was compiled or run"};
  trying.reset();
}

void TuningRecord::dropStale(const std::function<uint64_t(const std::string&)>& hashNow) {
  const auto isStale = [&](const ProgramStamp& program) { return hashNow(program.name) != program.hash; };
  std::erase_if(findings, [&](const auto& each) { return isStale(each.second.program); });
  std::erase_if(struckOff, [&](const auto& each) { return isStale({each.first, each.second.first}); });
  std::erase_if(suspects, [&](const auto& each) { return isStale({each.first, each.second}); });
  if (trying && isStale(*trying)) trying.reset();
  const size_t gone = std::erase_if(
      winners, [&](const auto& each) { return isStale(each.second.program) || isStale(each.second.fixedProgram); });
  if (gone > 0) frames.clear();  // they were timed with it
}

bool TuningRecord::isStruckOff(const ProgramStamp& program) const {
  const auto found = struckOff.find(program.name);
  return found != struckOff.end() && found->second.first == program.hash;
}

std::string toText(const TuningRecord& record) {
  std::string text = std::string(kFirstLine) + "\n";
  for (const auto& [key, found] : record.findings)
    text += (Line("finding") << key.first << key.second << found.program << uint64_t{found.right} << found.microseconds
                             << found.why)
                .str();
  for (const auto& [key, winner] : record.winners)
    text += (Line("winner") << key << winner.kernel << winner.program << winner.fixedProgram << winner.microseconds
                            << winner.fixedMicroseconds << uint64_t{winner.isFixed})
                .str();
  for (const auto& [name, struck] : record.struckOff)
    text += (Line("struck off") << ProgramStamp{name, struck.first} << struck.second).str();
  for (const auto& [name, frame] : record.frames)
    text += (Line("frame") << name << uint64_t{frame.taken} << frame.normsInLinear << frame.layersFused << frame.seconds
                           << frame.fixedSeconds << frame.tuningSeconds << std::to_string(frame.date) << frame.label)
                .str();
  for (const auto& [name, hash] : record.suspects) text += (Line("suspect") << ProgramStamp{name, hash}).str();
  if (record.trying) text += (Line(record.isFixedTried ? "trying the fixed choice" : "trying") << *record.trying).str();
  return text;
}

TuningRecord fromText(std::string_view text) {
  TuningRecord record;
  bool first = true;
  try {
    while (!text.empty()) {
      const size_t end = text.find('\n');
      if (end == std::string_view::npos) return {};
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(end + 1);
      if (!first)
        readLine(line, record);
      else if (line != kFirstLine)
        return {};
      first = false;
    }
  } catch (const Error&) {  // of another version, say
    return {};
  }
  return record;
}

TuningFile::TuningFile(const std::filesystem::path& folder, std::string driverKey) : driverKey_(std::move(driverKey)) {
  char name[40];
  std::snprintf(name, sizeof name, "tuning-%016llx.bin",
                static_cast<unsigned long long>(hashOf(std::as_bytes(std::span(driverKey_)))));
  if (!folder.empty()) path_ = folder / name;
}

TuningRecord TuningFile::read() const {
  {
    Unwritten& unwritten = Unwritten::ofProcess();
    const std::lock_guard lock(unwritten.access);
    const auto found = unwritten.records.find({path_, driverKey_});
    if (found != unwritten.records.end()) return found->second;
  }
  if (path_.empty()) return {};
  const std::vector<std::byte> content = readCacheFile(path_, driverKey_);
  return fromText({reinterpret_cast<const char*>(content.data()), content.size()});
}

bool TuningFile::write(const TuningRecord& record) const {
  const std::string text = toText(record);
  const bool isWritten = !path_.empty() && writeCacheFile(path_, driverKey_, std::as_bytes(std::span(text)));
  Unwritten& unwritten = Unwritten::ofProcess();
  const std::lock_guard lock(unwritten.access);
  if (isWritten)
    unwritten.records.erase({path_, driverKey_});
  else
    unwritten.records[{path_, driverKey_}] = record;
  return isWritten;
}

}  // namespace xrds
