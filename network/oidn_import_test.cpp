#include "network/oidn_import.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <random>

#include "engine/bytes.h"
#include "network/tza.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using Bytes = std::vector<std::byte>;

template <class T>
void append(Bytes& bytes, T number) {
  const auto* begin = reinterpret_cast<const std::byte*>(&number);
  bytes.insert(bytes.end(), begin, begin + sizeof(T));
}

void append(Bytes& bytes, const std::string& text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), begin, begin + text.size());
}

/// The entry of a tensor in the table.
struct Entry {
  std::string name;
  std::vector<uint32_t> shape;
  std::string layout, type = "h";
  uint64_t offset = 0;
};

/// An archive: tensors of ones behind the head, then the table.
struct Archive {
  std::vector<Entry> entries;
  uint64_t dataBytes = 12;

  void add(const std::string& name, const std::vector<uint32_t>& shape) {
    uint64_t elements = 1;
    for (const uint32_t side : shape) elements *= side;
    entries.push_back({name, shape, shape.size() == 1 ? "x" : "oihw", "h", dataBytes});
    dataBytes += 2 * elements;
  }
  Bytes bytes() const {
    Bytes bytes;
    append(bytes, uint16_t{0x41D7});
    append(bytes, uint8_t{2});
    append(bytes, uint8_t{0});
    append(bytes, dataBytes);
    while (bytes.size() < dataBytes) append(bytes, uint16_t{0x3c00});  // 1
    append(bytes, static_cast<uint32_t>(entries.size()));
    for (const Entry& entry : entries) {
      append(bytes, static_cast<uint16_t>(entry.name.size()));
      append(bytes, entry.name);
      append(bytes, static_cast<uint8_t>(entry.shape.size()));
      for (const uint32_t side : entry.shape) append(bytes, side);
      append(bytes, entry.layout + entry.type);
      append(bytes, entry.offset);
    }
    return bytes;
  }
};

// The tensors of a network of Open Image Denoise, as the architecture asks for them.
Archive archiveOf(const Metadata& fields) {
  Metadata metadata{{"format", "xrds"}, {"version", "1"}, {"architecture", "oidn"}, {"scale", "1"}};
  metadata.insert(fields.begin(), fields.end());
  Archive archive;
  makeTensors(parseConfig(metadata), [&](const std::string& name, StoredTensor& tensor) {
    archive.add(name, {tensor.shape.begin(), tensor.shape.end()});
  });
  return archive;
}

Archive smallHdr() { return archiveOf({{"size", "small"}, {"input", "hdr"}, {"aux_inputs", ""}}); }

Archive two() {
  Archive archive;
  archive.add("conv.weight", {4, 3, 3, 3});
  archive.add("conv.bias", {4});
  return archive;
}

std::string refusal(const Bytes& bytes) {
  try {
    parseTza(bytes, "file");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal(const std::function<void(Archive&)>& damage) {
  Archive archive = two();
  damage(archive);
  return refusal(archive.bytes());
}

TEST(Tza, ReadsTensors) {
  const TensorFile file = parseTza(two().bytes(), "file");
  ASSERT_EQ(file.tensors.size(), 2u);
  EXPECT_EQ(file.tensors.at("conv.weight").shape, (std::vector<uint64_t>{4, 3, 3, 3}));
  EXPECT_EQ(file.tensors.at("conv.bias").values, std::vector<float>(4, 1));
}

TEST(Tza, RefusesHostileArchives) {
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(has(refusal(Bytes(100)), "no TZA archive"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[0].shape[0] = 0; }), "side of 0"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[0].shape[1] = 0xffffffff; }), "which no network has"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[0].shape = {4096, 4096, 4096, 4096}; }), "outside of itself"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].offset = ~uint64_t{0}; }), "outside of itself"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].offset = a.entries[0].offset + 2; }), "share bytes"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].name = a.entries[0].name; }), "twice"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].name = "../../x"; }), "no name"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].name = std::string(300, 'a'); }), "no name"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].name.clear(); }), "no name"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[1].type = "q"; }), "unknown type"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[0].layout = "hwio"; }), "unknown layout"));
  EXPECT_TRUE(has(refusal([](Archive& a) { a.entries[0].shape = {4, 3}; }), "2 dimensions"));
  Bytes bytes = two().bytes();
  bytes.resize(bytes.size() - 3);
  EXPECT_TRUE(has(refusal(bytes), "outside of itself"));
  bytes = two().bytes();
  for (size_t i = 4; i < 12; ++i) bytes[i] = std::byte{0xff};  // where the table is
  EXPECT_TRUE(has(refusal(bytes), "outside of itself"));
}

TEST(OidnImport, MakesACompleteModelOfAnArchive) {
  const ImportedNetwork network = networkOfArchive(smallHdr().bytes(), "rt_hdr_small", "2.5.1");
  const NetworkModel model = NetworkModel::fromTensors(network.file, "imported");
  EXPECT_EQ(model.file().metadata.at("license"), "Apache-2.0");
  EXPECT_EQ(model.file().metadata.at("source"), "Open Image Denoise 2.5.1, rt_hdr_small");
  EXPECT_EQ(model.config().architecture, "oidn");
  EXPECT_THROW(networkOfArchive(smallHdr().bytes(), "rt_hdr", ""), Error);            // of another size
  EXPECT_THROW(networkOfArchive(smallHdr().bytes(), "rt_hdr_alb_small", ""), Error);  // takes an albedo
  EXPECT_THROW(networkOfArchive(smallHdr().bytes(), "something", ""), Error);
}

TEST(OidnImport, KnowsThePublishedSizes) {
  const auto parameters = [](const char* size, const char* guides) {
    const Metadata metadata{{"format", "xrds"}, {"version", "1"}, {"architecture", "oidn"}, {"scale", "1"},
                            {"size", size},     {"input", "hdr"}, {"aux_inputs", guides}};
    return NetworkModel::random(parseConfig(metadata), 1).parameterCount();
  };
  EXPECT_EQ(parameters("base", ""), 914'627u);
  EXPECT_EQ(parameters("small", "albedo,normal"), 320'035u);
  EXPECT_EQ(parameters("large", "albedo,normal"), 3'848'387u);
}

/// A library with one network behind a symbol: head, names, symbols, the archive, four sections.
struct Library {
  Bytes archive = smallHdr().bytes();
  std::string symbol = "_ZN4oidn5blobs7weights12rt_hdr_smallE";
  uint64_t value = 0x1000, size = archive.size(), sections = 0, link = 1, symbolSection = 3;
  unsigned char bits = 2;

  Bytes bytes() const {
    const std::string names = std::string(1, '\0') + "libOpenImageDenoise_core.so.2.5.1" + '\0' + symbol + '\0';
    const uint64_t namesAt = 64, symbolsAt = namesAt + names.size(), archiveAt = symbolsAt + 48;
    Bytes file;
    append(file, std::string("\x7f"
                             "ELF"));
    append(file, bits);
    append(file, uint8_t{1});
    file.resize(40);
    append(file, sections ? sections : archiveAt + archive.size());
    file.resize(58);
    append(file, uint16_t{64});
    append(file, uint16_t{4});
    file.resize(namesAt);
    append(file, names);
    file.resize(symbolsAt + 24);
    append(file, static_cast<uint32_t>(names.size() - symbol.size() - 1));
    append(file, uint16_t{0});
    append(file, static_cast<uint16_t>(symbolSection));
    append(file, value);
    append(file, size);
    file.insert(file.end(), archive.begin(), archive.end());
    const auto section = [&](uint32_t type, uint64_t address, uint64_t offset, uint64_t byteSize, uint64_t linked) {
      append(file, uint32_t{0});
      append(file, type);
      append(file, uint64_t{0});
      append(file, address);
      append(file, offset);
      append(file, byteSize);
      append(file, static_cast<uint32_t>(linked));
      file.resize(file.size() + 20);
    };
    section(0, 0, 0, 0, 0);
    section(3, 0, namesAt, names.size(), 0);
    section(11, 0, symbolsAt, 48, link);
    section(1, 0x1000, archiveAt, archive.size(), 0);
    return file;
  }
};

TEST(OidnImport, FindsNetworksByTheSymbolsOfALibrary) {
  const auto networks = networksOfLibrary(Library().bytes(), "library");
  ASSERT_EQ(networks.size(), 1u);
  EXPECT_EQ(networks[0].name, "rt_hdr_small");
  EXPECT_EQ(networks[0].file.metadata.at("source"), "Open Image Denoise 2.5.1, rt_hdr_small");
}

TEST(OidnImport, RefusesHostileLibraries) {
  const auto refused = [](const std::function<void(Library&)>& damage) {
    Library library;
    damage(library);
    EXPECT_THROW(networksOfLibrary(library.bytes(), "library"), Error);
  };
  refused([](Library& l) { l.bits = 1; });
  refused([](Library& l) { l.sections = ~uint64_t{0} - 3; });
  refused([](Library& l) { l.link = 77; });
  refused([](Library& l) { l.symbolSection = 9; });
  refused([](Library& l) { l.value = 0xfff; });
  refused([](Library& l) { l.value = ~uint64_t{0}; });
  refused([](Library& l) { l.size = ~uint64_t{0}; });
  refused([](Library& l) { l.symbol = "_ZN4oidn5blobs7weights14rtlightmap_hdrE"; });
  refused([](Library& l) { l.archive.resize(l.archive.size() / 2), l.size = l.archive.size(); });
  EXPECT_THROW(networksOfLibrary({}, "empty"), Error);
  EXPECT_THROW(importNetworks("does/not/exist.so"), Error);
}

// Whatever a byte of head, table, symbols or sections is turned into, the answer is a model or an Error.
TEST(OidnImport, NoByteFlipCrashes) {
  const Bytes library = Library().bytes();
  const Bytes archive = two().bytes();
  std::mt19937 random(29);
  int refused = 0;
  const auto turned = [&](Bytes bytes, size_t from) {
    for (int flip = 0; flip < 2; ++flip) bytes[from + random() % (bytes.size() - from)] ^= std::byte(1 << random() % 8);
    return bytes;
  };
  for (int trial = 0; trial < 300; ++trial) {
    try {
      parseTza(turned(archive, trial % 2 ? 0 : archive.size() - 60), "damaged");
    } catch (const Error&) {
      ++refused;
    }
  }
  for (int trial = 0; trial < 60; ++trial) {
    try {
      networksOfLibrary(turned(library, library.size() - 256), "damaged");
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 60);
}

}  // namespace
}  // namespace xrds
