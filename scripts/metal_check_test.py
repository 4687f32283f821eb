"""Tests of scripts/metal_check.py: python3 scripts/metal_check_test.py"""
import unittest

import metal_check

# As SPIRV-Cross writes what Metal takes, and what it does not.
MACRO = """
constant uint kGroup = SPIRV_CROSS_CONSTANT_ID_1;
constant uint kRun_tmp [[function_constant(2)]];
constant uint kRun = is_function_constant_defined(kRun_tmp) ? kRun_tmp : 4u;
"""
FUNCTION_CONSTANT = """
constant uint _66_tmp [[function_constant(0)]];
constant uint _66 = is_function_constant_defined(_66_tmp) ? _66_tmp : 1u;
constant uint3 gl_WorkGroupSize [[maybe_unused]] = uint3(_66, 1u, 1u);
constant uint kGroup = gl_WorkGroupSize.x;
constant uint kTexels = (kGroup * 2u);
"""
ARRAYS = {
    "    threadgroup float2 partial[kGroup];": ["kGroup"],
    "    threadgroup float4 x[4][kTexels];": ["kTexels"],
    "    spvUnsafeArray<float4, kTexels> sums;": ["kTexels"],
    "    spvUnsafeArray<spvUnsafeArray<float4, kGroup>, kTexels> sums;": ["kGroup", "kTexels"],
    "    float found = partial[kGroup];": [],  # no array, but one of its elements
}


class MetalCheck(unittest.TestCase):
    def test_arrays_whose_size_metal_does_not_take_are_found(self):
        for array, sizes in ARRAYS.items():
            self.assertEqual(metal_check.sizes_of_function_constants(FUNCTION_CONSTANT + array), sizes, array)
            self.assertEqual(metal_check.sizes_of_function_constants(MACRO + array), [], array)

    def test_numbers_are_not_asked_whether_they_are_finite(self):
        self.assertEqual(metal_check.tests_of_finiteness("bool lost = any(isnan(x)) || any(isinf(x)) || isnan(y);"), ["isinf", "isnan"])
        self.assertEqual(metal_check.tests_of_finiteness("bool lost = spvisnan_(x) < as_type<uint3>(x);  // no isnan"), [])

    def test_kernels_that_no_mac_runs_are_left_out(self):
        for name in ("linear_lane_f32", "conv3x3_lane4_f32", "linear_matrix_nv_f16", "linear_matrix_khr_f16"):
            self.assertTrue(metal_check.NOT_FOR_METAL.search(name), name)
        for name in ("linear_tile_f16", "exposure_plain_f32", "take_exposure"):
            self.assertFalse(metal_check.NOT_FOR_METAL.search(name), name)


if __name__ == "__main__":
    unittest.main()
