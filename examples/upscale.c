/* Upscales a render with albedo and normals, all as portable float maps (PFM):
 *
 *     cc upscale.c $(pkg-config --cflags --libs xrds) -o upscale
 *     ./upscale xrds-x4-compact colour.pfm albedo.pfm normal.pfm result.pfm
 *
 * With an xrds of scripts/install.sh first:
 *
 *     export PKG_CONFIG_PATH=~/.local/lib/pkgconfig LD_LIBRARY_PATH=~/.local/lib */
#include <stdio.h>
#include <stdlib.h>
#include <xrds/xrds.h>

static void check(XrdsResult result) {
  if (result == XRDS_OK) return;
  fprintf(stderr, "%s\n", xrdsGetMessage());
  exit(1);
}

/* Three floats a pixel, rows from the bottom, as the format has them. */
static XrdsImage image(void* pixels, uint32_t width, uint32_t height) {
  XrdsImage made = xrdsInterleavedImage(pixels, XRDS_FLOAT, 3, width, height);
  for (int c = 0; c < 3; ++c) made.channels[c] = (float*)pixels + (size_t)3 * width * (height - 1) + c;
  made.rowStride = -made.rowStride;
  return made;
}

static XrdsImage readPfm(const char* path) {
  unsigned width, height;
  FILE* file = fopen(path, "rb");
  if (!file || fscanf(file, "PF %u %u -%*f%*1[\n]", &width, &height) != 2) {
    fprintf(stderr, "%s is no little-endian colour PFM\n", path);
    exit(1);
  }
  float* pixels = calloc((size_t)width * height, 3 * sizeof *pixels);
  const size_t count = fread(pixels, 3 * sizeof *pixels, (size_t)width * height, file);
  fclose(file);
  if (count != (size_t)width * height) exit(1);
  return image(pixels, width, height);
}

int main(int count, char** arguments) {
  if (count != 6) return fprintf(stderr, "usage: %s MODEL COLOUR ALBEDO NORMAL RESULT\n", arguments[0]), 2;
  XrdsDevice* device;
  XrdsModel* model;
  XrdsUpscaler* upscaler;
  check(xrdsOpenDevice(NULL, &device));
  check(xrdsOpenModel(arguments[1], &model));
  const XrdsImage colour = readPfm(arguments[2]), guides[] = {readPfm(arguments[3]), readPfm(arguments[4])};
  check(xrdsCreateUpscaler(device, model, colour.width, colour.height, NULL, &upscaler));
  const uint32_t width = xrdsGetModelScale(model) * colour.width, height = xrdsGetModelScale(model) * colour.height;
  float* result = malloc((size_t)width * height * 3 * sizeof *result);
  const XrdsImage output = image(result, width, height);
  check(xrdsUpscale(upscaler, &colour, guides, 2, &output, NULL, NULL));
  FILE* file = fopen(arguments[5], "wb");
  if (!file || fprintf(file, "PF\n%u %u\n-1\n", width, height) < 0) return perror(arguments[5]), 1;
  fwrite(result, 3 * sizeof *result, (size_t)width * height, file);
  return fclose(file) != 0;
}
