#pragma once

namespace xrds {

/// Throws Failure with ExitCode::usage if the environment variable XRDS_KERNEL_FAMILY names no kernel family.
void checkKernelFamilyVariable();

}  // namespace xrds
