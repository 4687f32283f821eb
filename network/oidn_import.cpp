#include "network/oidn_import.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

#include "network/tza.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint64_t kMostBytes = uint64_t{1} << 30;

/// What each network of the RT filter takes.
struct Kind {
  const char *name, *input, *guides;
};
constexpr Kind kKinds[] = {
    {"rt_hdr", "hdr", ""},
    {"rt_hdr_alb", "hdr", "albedo"},
    {"rt_hdr_alb_nrm", "hdr", "albedo,normal"},
    {"rt_hdr_calb_cnrm", "hdr", "albedo,normal"},
    {"rt_ldr", "ldr", ""},
    {"rt_ldr_alb", "ldr", "albedo"},
    {"rt_ldr_alb_nrm", "ldr", "albedo,normal"},
    {"rt_ldr_calb_cnrm", "ldr", "albedo,normal"},
    {"rt_alb", "albedo", ""},
    {"rt_nrm", "normal", ""},
};
constexpr const char* kSizes[] = {"base", "small", "large"};

// "rt_alb_large" of its kind and size.
std::string nameOf(const Kind& kind, const char* size) {
  return std::string(kind.name) + (size == std::string("base") ? "" : std::string("_") + size);
}

// The head of an ELF file, of a section and of a symbol, as the System V ABI has them.
struct ElfHead {
  unsigned char ident[16];
  uint16_t type, machine;
  uint32_t version;
  uint64_t entry, programs, sections;
  uint32_t flags;
  uint16_t headBytes, programBytes, programCount, sectionBytes, sectionCount, names;
};
struct ElfSection {
  uint32_t name, type;
  uint64_t flags, address, offset, byteSize;
  uint32_t link, extra;
  uint64_t alignment, entryBytes;
};
struct ElfSymbol {
  uint32_t name;
  unsigned char kind, other;
  uint16_t section;
  uint64_t value, byteSize;
};
constexpr uint32_t kSymbolTable = 2, kDynamicSymbols = 11;

/// The symbols of an ELF file, with the bytes that they name.
class Library {
 public:
  Library(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {
    const ElfHead head = at<ElfHead>(0);
    constexpr unsigned char kIdent[] = {0x7f, 'E', 'L', 'F', 2, 1};  // 64 bits, little-endian
    if (std::memcmp(head.ident, kIdent, sizeof kIdent) != 0)
      throw Error(name +
                  " is no library of Open Image Denoise for 64-bit Linux, whose networks can be read: take "
                  "libOpenImageDenoise_core.so of the package of your system or of pip install pyoidn, or a .tza "
                  "file.");
    if (head.sectionBytes != sizeof(ElfSection)) throw damaged();
    for (uint64_t i = 0; i < head.sectionCount; ++i)
      sections_.push_back(at<ElfSection>(head.sections, i * sizeof(ElfSection)));
  }

  /// Those of the symbol whose mangled name ends so; nothing if there is none.
  std::optional<std::span<const std::byte>> find(const std::string& ending) const {
    for (const ElfSection& table : sections_) {
      if (table.type != kSymbolTable && table.type != kDynamicSymbols) continue;
      if (table.link >= sections_.size()) throw damaged();
      const std::span<const std::byte> names = bytesOf(sections_[table.link]);
      const uint64_t count = bytesOf(table).size() / sizeof(ElfSymbol);
      for (uint64_t i = 0; i < count; ++i) {
        const auto symbol = at<ElfSymbol>(table.offset, i * sizeof(ElfSymbol));
        if (nameAt(names, symbol.name).ends_with(ending)) return bytesOf(symbol);
      }
    }
    return {};
  }

 private:
  Error damaged() const { return Error(name_ + " points outside of itself: it is truncated or damaged."); }
  template <class T>
  T at(uint64_t offset, uint64_t more = 0) const {
    if (offset > bytes_.size() || more > bytes_.size() - offset || sizeof(T) > bytes_.size() - offset - more)
      throw damaged();
    T value;
    std::memcpy(&value, &bytes_[offset + more], sizeof(T));
    return value;
  }
  std::span<const std::byte> range(uint64_t offset, uint64_t byteSize) const {
    if (offset > bytes_.size() || byteSize > bytes_.size() - offset) throw damaged();
    return bytes_.subspan(offset, byteSize);
  }
  std::span<const std::byte> bytesOf(const ElfSection& section) const {
    return range(section.offset, section.byteSize);
  }
  std::span<const std::byte> bytesOf(const ElfSymbol& symbol) const {
    if (symbol.section >= sections_.size()) throw damaged();
    const ElfSection& section = sections_[symbol.section];
    if (symbol.value < section.address || symbol.value - section.address > section.byteSize ||
        symbol.byteSize > section.byteSize - (symbol.value - section.address))
      throw damaged();
    return bytesOf(section).subspan(symbol.value - section.address, symbol.byteSize);
  }
  static std::string_view nameAt(std::span<const std::byte> names, uint64_t offset) {
    if (offset >= names.size()) return {};
    const auto* begin = reinterpret_cast<const char*>(names.data());
    const auto* end = std::find(begin + offset, begin + names.size(), '\0');
    return {begin + offset, static_cast<size_t>(end - begin) - offset};
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
  std::vector<ElfSection> sections_;
};

// Its soname ends in the version: libOpenImageDenoise_core.so.2.5.1, or libOpenImageDenoise.so.1.
std::string versionOf(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const char* soname : {"libOpenImageDenoise_core.so.", "libOpenImageDenoise.so."}) {
    const size_t found = text.find(soname);
    if (found == std::string_view::npos) continue;
    const std::string_view rest = text.substr(found + std::strlen(soname), 16);
    return std::string(rest.substr(0, std::min(rest.find_first_not_of("0123456789."), rest.size())));
  }
  return {};
}

std::vector<std::byte> contentOf(const std::filesystem::path& path) {
  const std::string name = "'" + path.string() + "'";
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) throw Error("Cannot read " + name + ": " + error.message() + ".");
  if (size > kMostBytes) throw Error(name + " is larger than 1 GiB, which no library of Open Image Denoise is.");
  std::vector<std::byte> bytes(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    throw Error("Cannot read " + name + ".");
  return bytes;
}

}  // namespace

ImportedNetwork networkOfArchive(std::span<const std::byte> bytes, const std::string& archive,
                                 const std::string& version) {
  for (const Kind& kind : kKinds)
    for (const char* size : kSizes) {
      if (nameOf(kind, size) != archive) continue;
      ImportedNetwork network{archive, parseTza(bytes, "The archive '" + archive + "'")};
      network.file.metadata = {
          {"format", "xrds"},
          {"version", "1"},
          {"architecture", "oidn"},
          {"scale", "1"},
          {"size", size},
          {"input", kind.input},
          {"aux_inputs", kind.guides},
          {"license", "Apache-2.0"},
          {"source", "Open Image Denoise" + (version.empty() ? "" : " " + version) + ", " + archive}};
      NetworkModel::fromTensors(network.file, "The archive '" + archive + "'");
      return network;
    }
  throw Error("'" + archive + "' is no network of Open Image Denoise's RT filter, such as rt_hdr_alb_nrm.");
}

std::vector<ImportedNetwork> networksOfLibrary(std::span<const std::byte> bytes, const std::string& name) {
  const Library library(bytes, name);
  const std::string version = versionOf(bytes);
  std::vector<ImportedNetwork> networks;
  for (const Kind& kind : kKinds)
    for (const char* size : kSizes) {
      const std::string archive = nameOf(kind, size);
      if (const auto found = library.find(std::to_string(archive.size()) + archive + "E"))
        networks.push_back(networkOfArchive(*found, archive, version));
    }
  if (networks.empty())
    throw Error(name + " holds no networks of Open Image Denoise: they are in libOpenImageDenoise_core.so.");
  return networks;
}

std::vector<ImportedNetwork> importNetworks(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = contentOf(path);
  if (isTza(bytes)) return {networkOfArchive(bytes, path.stem().string(), "")};
  return networksOfLibrary(bytes, "'" + path.string() + "'");
}

}  // namespace xrds
