// tokenQuad(token, quad): four channels of x, which lie in `source` and, behind its own, in `appended`. Included after the
// two samplers, kHasAppended and the parameters p.
#ifndef XRDS_SHADERS_LINEAR_TOKEN_GLSL
#define XRDS_SHADERS_LINEAR_TOKEN_GLSL

vec4 tokenQuad(uint token, uint quad) {
  if (kHasAppended && quad >= p.sourceChannels / 4)
    return texelFetch(appended, int(token * p.appended.stride + p.appended.offset + quad - p.sourceChannels / 4));
  return texelFetch(source, int(token * p.source.stride + p.source.offset + quad));
}

#endif
