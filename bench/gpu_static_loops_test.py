"""Tests of bench/gpu_static_loops.py: python3 bench/gpu_static_loops_test.py"""
import unittest

import gpu_static_loops

ASSEMBLY = """BB0:
	v_mov_b32_e32 v1, v0                                        ; 7e020300
BB1:
	v_add_f32 v1, v1, v1                                        ; 00000000
	s_cbranch_scc0 BB5                                          ; bfa10040
BB2:
	ds_load_u16 v3, v1                                          ; 00000000
	ds_load_b128 v[4:7], v1                                     ; 00000000
	s_waitcnt lgkmcnt(0)                                        ; 00000000
	v_wmma_f32_16x16x16_f16 v[8:15], v[0:7], v[0:7], v[8:15]    ; 00000000
	v_add_nc_u32_e32 v4, 4, v1                                  ; 4a0802ff
	s_cbranch_scc1 BB2                                          ; 00000000
BB3:
	v_fma_f32 v1, v1, v1, v1                                    ; 00000000
	s_branch BB1                                                ; 00000000
BB5:
	s_endpgm                                                    ; bfb00000
"""
NAK = """block.u 0 L2 [] -> {
      b0        = bssy b0 pT L0                        // delay=1
                  nop L0                               // delay=1
      r0        = ldc.b32 c[0x0][+0x724]               // delay=1 wr:1
      r4..8     = ld.shared.b128 [r1+0x10]             // delay=1
      r8..10    = ldsm.16.m8n8.x2 [r1]                 // delay=1
  @p0 r10       = ld.shared.u16 [r1]                   // delay=1
      r12       = tld.a r2 // ld.local
      r4..8     = hmma.m16n8k16.f32 r0..4 r8..10 r4..8 // delay=1
}
"""
GEN = """START B1 (40 cycles)
add(8)          g81.8<1>UW      g81<8,8,1>UW    0x0008UW        { align1 WE_all 1Q @1 compacted };
(+f0.0) mad(16) g82<1>F         g79<8,8,1>F     g77<8,8,1>F     { align1 1H @1 };
dpas.8x8(16)    g10<1>F         g10<1,1,0>F     g42<1,1,0>HF    g58<1,1,0>HF { align1 1H };
                            sampler MsgDesc: ld_lz SIMD16 Surface = 1 Sampler = 0
"""


class Loops(unittest.TestCase):
    def test_a_loop_is_what_a_branch_goes_back_over(self):
        lengths = sorted(len(operations) for operations in gpu_static_loops.loops(ASSEMBLY))
        self.assertEqual(lengths, [6, 10])

    def test_the_inner_loop_has_the_densest_products(self):
        loop = gpu_static_loops.inner_loop(ASSEMBLY)
        self.assertEqual((loop["products"], loop["vector"], loop["sharedLoads"], loop["waits"], loop["gathers16"], loop["all"]), (1, 1, 2, 1, 1, 6))
        self.assertNotIn("multiplyAdds", loop)
        self.assertEqual(loop["productShare"], round(16 / 17, 3))

    def test_nak_is_counted_as_a_whole(self):
        counts = gpu_static_loops.whole_program(NAK)
        self.assertEqual((counts["products"], counts["sharedLoads"], counts["loads"], counts["gathers16"], counts["all"]), (1, 3, 1, 1, 8))
        self.assertNotIn("scratch", counts)
        self.assertIsNone(gpu_static_loops.whole_program(""))

    def test_unrolled_products_are_those_of_the_whole(self):
        unrolled = ASSEMBLY.replace("s_cbranch_scc1 BB2", "s_nop 0").replace("s_branch BB1", "s_nop 0")
        counts = gpu_static_loops.inner_loop(unrolled)
        self.assertEqual((counts["products"], counts["multiplyAdds"], counts["all"]), (1, 1, 12))

    def test_without_products_there_is_none(self):
        self.assertIsNone(gpu_static_loops.inner_loop("BB0:\n\ts_endpgm   ; bfb00000\n"))

    def test_operations_have_kinds(self):
        for operation, kind in {"v_dual_fmac_f32": "multiplyAdds", "v_pk_fma_f16": "multiplyAdds", "v_cvt_f16_f32": "vector", "s_and_b32": "scalar",
                                "buffer_load_format_xyzw": "loads", "global_store_b64": "stores", "ds_store_b128": "sharedStores", "s_barrier": "barriers",
                                "scratch_load_b32": "scratch", "s_wait_dscnt": "waits"}.items():
            self.assertEqual(gpu_static_loops.kind(operation), kind, operation)
        for operation, gathers in {"ds_load_u16_d16_hi": True, "buffer_load_u16": True, "buffer_load_b128": False, "buffer_load_ushort": True,
                                   "ds_read_u16": True, "buffer_load_format_xyzw": False, "buffer_store_short": False}.items():
            self.assertEqual(gpu_static_loops.is_gather16(operation), gathers, operation)

    def test_of_intel_the_whole_program_counts(self):
        self.assertEqual(gpu_static_loops.whole_gen_program(GEN), {"products": 1, "multiplyAdds": 1, "all": 3})
        self.assertIsNone(gpu_static_loops.whole_gen_program(""))


if __name__ == "__main__":
    unittest.main()
