// How the subgroups of a workgroup make columns of 16 outputs of a window: biases, tokens and products in sums, and their way to
// the pool. Included after the weights, the pool and its strides.
#ifndef XRDS_SHADERS_SWIN_LAYER_COLUMNS_GLSL
#define XRDS_SHADERS_SWIN_LAYER_COLUMNS_GLSL
// Columns of 16 outputs, of which a subgroup makes its rows of every kColumnGroups-th.
uint firstRow() { return subgroupIndex() % kRowGroups * kRows; }
#define COLUMN(j) ((j) * kColumnGroups + subgroupIndex() / kRowGroups)
#define COLUMNS_OF(total) (((total) + kColumnGroups - 1) / kColumnGroups)
#define HAS_COLUMN(j, total) (((j) + 1) * kColumnGroups <= (total) || COLUMN(j) < (total))  // mostly known to the compiler
#define EACH_COLUMN(j, count, total) [[unroll]] for (uint j = 0; j < (count); j++) if (HAS_COLUMN(j, total))
#define FOR_ROWS [[unroll]] for (uint r = 0; r < kRows; r++)
#define ROW_AT(at, stride) ((at) + 16 * (firstRow() + r) * (stride))
#define TAKE_BIAS(sums, tileAt)                                                         \
  {                                                                                     \
    LEFT_FRAGMENT(ones);                                                                \
    FILL_LEFT(ones, 1.0);                                                               \
    RIGHT_FRAGMENT(bias);                                                               \
    LOAD_RIGHT(bias, weights, tileAt, 2);                                               \
    CLEAR_SUM(sums[0]);                                                                 \
    MULTIPLY_ADD(ones, bias, sums[0]);                                                  \
    [[unroll]] for (uint r = 1; r < kRows; r++) COPY_SUM(sums[r], sums[0]);             \
  }
#define ADD_TOKENS(sums, column)                                                        \
  {                                                                                     \
    RIGHT_FRAGMENT(identity);                                                           \
    LOAD_RIGHT(identity, weights, kIdentityAt, 2);                                      \
    FOR_ROWS {                                                                          \
      LEFT_FRAGMENT(t);                                                                 \
      LOAD_LEFT(t, pool, ROW_AT(2 * (column), kTokenStride), kTokenStride);             \
      MULTIPLY_ADD(t, identity, sums[r]);                                               \
    }                                                                                   \
  }
// Rows of the pool times the tiles of `count` columns, of which those of the first column begin at tileAt.
#define ADD_PRODUCTS(sums, count, total, leftAt, leftStride, tileAt, columnTexels, depth) \
  for (uint k = 0; k < (depth) / 16; k++) {                                             \
    LEFT_FRAGMENTS(x, kRows);                                                           \
    FOR_ROWS LOAD_LEFT(x[r], pool, ROW_AT((leftAt) + 2 * k, leftStride), leftStride);   \
    EACH_COLUMN(j, count, total) {                                                      \
      RIGHT_FRAGMENT(w);                                                                \
      LOAD_RIGHT(w, weights, (tileAt) + COLUMN(j) * (columnTexels) + k * kTile, 2);     \
      FOR_ROWS MULTIPLY_ADD(x[r], w, sums[j][r]);                                       \
    }                                                                                   \
  }
#define STORE_ROWS(function, sums, at, stride)                                          \
  FOR_ROWS {                                                                            \
    APPLY(function, sums[r]);                                                           \
    STORE_HALVES(sums[r], pool, ROW_AT(at, stride), stride);                            \
  }

#endif
