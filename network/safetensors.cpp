#include "network/safetensors.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/bytes.h"
#include "engine/replace_file.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using Json = nlohmann::json;
constexpr uint64_t kMaxFileBytes = uint64_t{1} << 30;
constexpr uint64_t kMaxHeaderBytes = uint64_t{1} << 24;

uint32_t elementBytes(const std::string& type) { return type == "F32" ? 4 : type == "F16" || type == "BF16" ? 2 : 0; }

std::vector<float> numbersOf(std::span<const std::byte> bytes, const std::string& type) {
  if (type != "BF16") return decode(bytes, type == "F32" ? DataType::f32 : DataType::f16);
  std::vector<float> numbers(bytes.size() / 2);
  for (size_t i = 0; i < numbers.size(); ++i) {
    uint16_t bits;
    std::memcpy(&bits, &bytes[2 * i], 2);
    numbers[i] = std::bit_cast<float>(uint32_t{bits} << 16);
  }
  return numbers;
}

// Of a list of whole numbers: others, such as 9e72, convert to nothing sensible.
std::vector<uint64_t> sizesOf(const Json& list, const std::string& what) {
  std::vector<uint64_t> sizes;
  for (const Json& size : list) {
    if (!size.is_number_unsigned()) throw Error(what + " has a shape or an offset that is no whole number.");
    sizes.push_back(size.get<uint64_t>());
  }
  return sizes;
}

StoredTensor parseTensor(const Json& entry, std::span<const std::byte> bytes, const std::string& what) {
  const auto type = entry.at("dtype").get<std::string>();
  const std::vector<uint64_t> offsets = sizesOf(entry.at("data_offsets"), what);
  StoredTensor tensor{sizesOf(entry.at("shape"), what), {}};
  if (elementBytes(type) == 0) throw Error(what + " has element type " + type + ", expected F32, F16 or BF16.");
  uint64_t count = 1;
  for (const uint64_t side : tensor.shape) {
    if (side != 0 && count > kMaxFileBytes / side) throw Error(what + " is impossibly large.");
    count *= side;
  }
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > bytes.size())
    throw Error(what + " points outside the file: it is truncated or damaged.");
  if (offsets[1] - offsets[0] != count * elementBytes(type)) throw Error(what + " has a size that belies its shape.");
  tensor.values = numbersOf(bytes.subspan(offsets[0], offsets[1] - offsets[0]), type);
  return tensor;
}

Json parseHeader(std::span<const std::byte> bytes, const std::string& name) {
  uint64_t headerBytes = 0;
  if (bytes.size() >= 8) std::memcpy(&headerBytes, bytes.data(), 8);
  if (bytes.size() < 8 || headerBytes > kMaxHeaderBytes || headerBytes > bytes.size() - 8)
    throw Error(name + " is no safetensors file, or it is truncated.");
  const char* text = reinterpret_cast<const char*>(bytes.data() + 8);
  std::set<std::string> names;
  std::string twice;
  const auto listen = [&](int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth == 1 && event == Json::parse_event_t::key && !names.insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  Json header = Json::parse(text, text + headerBytes, listen, false);
  if (!header.is_object()) throw Error(name + " has no readable safetensors header.");
  if (!twice.empty()) throw Error(name + " has the tensor '" + twice + "' twice.");
  return header;
}

}  // namespace

TensorFile parseTensors(std::span<const std::byte> bytes, const std::string& name) {
  const Json header = parseHeader(bytes, name);
  uint64_t headerBytes = 0;
  std::memcpy(&headerBytes, bytes.data(), 8);
  TensorFile file;
  const std::span<const std::byte> body = bytes.subspan(8 + headerBytes);
  uint64_t claimedBytes = 0;
  try {
    for (const auto& [key, entry] : header.items()) {
      if (key == "__metadata__") {
        file.metadata = entry.get<Metadata>();
        continue;
      }
      const StoredTensor& tensor = file.tensors[key] = parseTensor(entry, body, name + ": tensor '" + key + "'");
      claimedBytes += tensor.values.size() * elementBytes(entry.at("dtype").get<std::string>());
      if (claimedBytes > body.size()) throw Error(name + " has tensors that share bytes.");
    }
  } catch (const Json::exception&) {
    throw Error(name + " has a safetensors header with a wrong or missing field.");
  }
  file.hash = hashOf(bytes);
  return file;
}

TensorFile readTensors(const std::filesystem::path& path) {
  const std::string name = "'" + path.string() + "'";
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) throw Error("Cannot read " + name + ": " + error.message() + ".");
  if (size > kMaxFileBytes) throw Error(name + " is larger than 1 GiB, which no weight file of ours is.");
  std::vector<std::byte> bytes(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    throw Error("Cannot read " + name + ".");
  return parseTensors(bytes, name);
}

void writeTensors(const std::filesystem::path& path, const TensorFile& file, DataType type) {
  Json header = {{"__metadata__", file.metadata}};
  std::vector<std::byte> body;
  for (const auto& [name, tensor] : file.tensors) {
    const uint64_t begin = body.size();
    const std::vector<std::byte> bytes = encode(tensor.values, type);
    body.insert(body.end(), bytes.begin(), bytes.end());
    header[name] = {{"dtype", type == DataType::f16 ? "F16" : "F32"},
                    {"shape", tensor.shape},
                    {"data_offsets", {begin, body.size()}}};
  }
  std::string text = header.dump();
  text.append((8 - text.size() % 8) % 8, ' ');
  const uint64_t headerBytes = text.size();
  if (!replaceFile(path, {std::as_bytes(std::span(&headerBytes, 1)), std::as_bytes(std::span(text)), body}))
    throw Error("Cannot write '" + path.string() + "': check the folder and the space left.");
}

}  // namespace xrds
