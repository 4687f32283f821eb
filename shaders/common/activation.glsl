// activate(kind, v): the activations of activation.h on four channels; `kind` is a specialization constant.
#ifndef XRDS_SHADERS_COMMON_ACTIVATION_GLSL
#define XRDS_SHADERS_COMMON_ACTIVATION_GLSL
#include "shaders/common/activation.h"

// erf by Abramowitz and Stegun 7.1.26 (|error| < 1.5e-7): GLSL has none.
vec4 erf4(vec4 x) {
  const vec4 a = abs(x);
  const vec4 t = 1.0 / (1.0 + 0.3275911 * a);
  const vec4 poly =
      t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
  return sign(x) * (1.0 - poly * exp(-a * a));
}

vec4 activate(uint kind, vec4 v) {
  if (kind == kActivationRelu) return max(v, 0.0);
  if (kind == kActivationLeakyRelu) return max(v, 0.01 * v);
  if (kind == kActivationGelu) return 0.5 * v * (1.0 + erf4(v * 0.70710678118654752));
  return v;
}

#endif
