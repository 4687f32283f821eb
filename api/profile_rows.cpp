#include "api/frame_upscaler.h"

namespace xrds {

std::vector<Upscaler::ProfileRow> profileRows(std::span<const DispatchTime> times) {
  std::vector<Upscaler::ProfileRow> rows;
  for (const DispatchTime& time : times)
    rows.push_back({time.label, time.program, time.multiplyAdds, time.byteSize, time.microseconds});
  return rows;
}

}  // namespace xrds
