#pragma once

#include <nanobind/nanobind.h>

namespace xrds::python {

/// Adds TemporalFilter, which merges frames of an animation, to the module.
void bindTemporalFilter(nanobind::module_& module);

}  // namespace xrds::python
