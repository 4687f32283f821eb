#pragma once

#include <span>

#include "xrds/upscaler.h"
#include "xrds/xrds_report.h"

namespace xrds::c {

/// Tells each row, in order.
void tellProfile(std::span<const Upscaler::ProfileRow> rows, XrdsHearProfile hear, void* user);

}  // namespace xrds::c
