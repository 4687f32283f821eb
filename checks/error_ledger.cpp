#include "checks/error_ledger.h"

#include <algorithm>
#include <iterator>

namespace xrds {

const LedgerEntry& ledgerEntry(const Operator& op) {
  const std::string program = std::visit([](const auto& o) { return dispatch(o, DeviceTraits{}).program; }, op);
  const auto found = std::find_if(std::begin(kErrorLedger), std::end(kErrorLedger), [&](const LedgerEntry& entry) {
    return program.starts_with(std::string(entry.op) + "_");
  });
  XRDS_CHECK(found != std::end(kErrorLedger));
  return *found;
}

}  // namespace xrds
