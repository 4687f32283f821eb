"""The image pipeline around the network: exposure, radiance transform, base image, padding, and their inverses.

Images are [batch, channels, height, width] linear radiance; x is the transformed low-resolution colour the network sees, `full` the
full-resolution noisy colour H of the auxiliary render, `aux` the other auxiliary images (`config.guides`), lights among them unexposed.
"""
import dataclasses
import math

import torch
import torch.nn.functional as F

EPSILON = 0.02        # added to the albedo before dividing and multiplying
ALBEDO_MAX = 4.0
TRANSFORMED_MAX = 11.0
SIGMA_SPACE, SIGMA_NORMAL, SIGMA_ALBEDO = 0.75, 0.2, 0.5
SIGMA_PREFILTER = 1.8               # of the prefilter's spatial weights, in steps of a level
PREFILTER_STEP = 3                  # a level's step over that of the one below
LOGIT_MAX = 8.0
SHARE_LOGIT_MAX = 20.0               # the same of a share's
CEILING_FACTOR, CEILING_SIDE = 4.0, 5    # of the result to the largest radiance around, low-resolution pixels
LEVEL_FLOOR, LEVEL_RATIO_MAX = 0.01, 8.0     # of levelled_colour
DEPTH_SCALES = (0.25, 1.0, 4.0)     # distances, over the median, that become one half
DEPTH_MAX = 1e8                     # what is as far is background
REC709 = (0.2126, 0.7152, 0.0722)


def auto_exposure(colour):
    """0.18 / exp(mean(log L)) over the pixels [3, h, w] with finite Rec. 709 luminance L > 1e-8 (mean(L^(1/8)))^8; 1 if there are none.

    Negative channels count as 0. The inner mean is over all finite L > 1e-37. The exposure of k times the image is that of the image over k.
    """
    luminance = sum(weight * channel for weight, channel in zip(REC709, colour.double().clamp(min=0)))
    luminance = luminance[torch.isfinite(luminance) & (luminance > 1e-37)]
    if not luminance.numel():
        return 1.0
    luminance = luminance[luminance > 1e-8 * luminance.pow(1 / 8).mean() ** 8]
    return 0.18 / math.exp(luminance.log().mean().item())


def relative_depth(depth):
    """Distances [1, H, W] in any unit -> [3, H, W]: d / (d + c m) for c of DEPTH_SCALES and the (lower) median m of the image.

    Distances that are 0, negative, not finite or at least 1e8 are background: they become 1 and do not count for the median.
    """
    seen = (depth > 0) & (depth < DEPTH_MAX)
    median = depth[seen].median() if seen.any() else 1.0
    depth = torch.where(seen, depth, torch.ones_like(depth))
    return torch.cat([torch.where(seen, depth / (depth + scale * median), torch.ones_like(depth)) for scale in DEPTH_SCALES])


def depth_planes(relative):
    """The three planes out of the middle one [..., 1, H, W], d / (d + m)."""
    return torch.cat([relative / (relative + scale * (1 - relative)) for scale in DEPTH_SCALES], -3)


def transform(x, transfer):
    """T: log(1 + max(x, 0)) or identity."""
    return torch.log1p(x.clamp(min=0)) if transfer == "log1p" else x


def inverse_transform(x, transfer):
    """T^-1."""
    return torch.expm1(x) if transfer == "log1p" else x


def box_mean(x, scale):
    """Mean over scale x scale pixels: [b, c, s*h, s*w] -> [b, c, h, w]."""
    return F.avg_pool2d(x, scale) if scale > 1 else x


def bicubic(x, scale):
    """Cubic upsampling, parameter -0.75, half-pixel centres, edge replication."""
    return F.interpolate(x, scale_factor=scale, mode="bicubic", align_corners=False) if scale > 1 else x


def merged_colour(colour, k, full, full_k, scale):
    """The low-resolution colour [..., 3, h, w] of k samples a pixel and the full-resolution one [..., 3, s*h, s*w] of full_k, each weighted by
    its samples: (k L + s^2 K box(H)) / (k + s^2 K). What is negative or not finite in H counts as 0."""
    more = scale ** 2 * full_k
    return (k * colour + more * box_mean(finite(full), scale)) / (k + more)


def levelled_colour(full, merged, scale):
    """The full-resolution colour H [..., 3, s*h, s*w] at the level of the merged one M [..., 3, h, w]: H (M + t) / (box(H) + t), the ratio at
    most LEVEL_RATIO_MAX, t the mean of M over pixels and channels times LEVEL_FLOOR. Its box means have the noise of both renders' samples,
    and only what is finer that of H alone."""
    full = finite(full)
    floor = LEVEL_FLOOR * merged.mean((-3, -2, -1), keepdim=True)
    means = box_mean(full.reshape(-1, *full.shape[-3:]), scale).reshape(merged.shape)
    ratio = ((merged + floor) / (means + floor).clamp(min=1e-30)).clamp(max=LEVEL_RATIO_MAX)
    return full * ratio.repeat_interleave(scale, -2).repeat_interleave(scale, -1)


def finite(image):
    """The image with 0 for what is negative or not finite."""
    return torch.where(image.isfinite(), image, 0).clamp(min=0)


def clamped_albedo(aux, config):
    """[b, 3, H, W] albedo in [0, 4], or None when the model has no albedo."""
    if aux is None or "albedo" not in config.guides:
        return None
    first = 3 * config.guides.index("albedo")
    return aux[:, first:first + 3].clamp(0, ALBEDO_MAX)


def clamped_aux(aux, config):
    """The auxiliary images but for the colour, the albedo clamped; None without."""
    if not config.guides:
        return None
    if "albedo" not in config.guides:
        return aux
    first = 3 * config.guides.index("albedo")
    return torch.cat([aux[:, :first], clamped_albedo(aux, config), aux[:, first + 3:]], 1)


def with_lights(aux, change, config):
    """The auxiliary images [..., A, H, W] with change(light) in the place of each diffuse or glossy light [..., 3, H, W]."""
    if not config.first_lights:
        return aux
    images = list(aux.split(3, -3))
    for first in config.first_lights:
        images[first // 3] = change(images[first // 3])
    return torch.cat(images, -3)


def network_aux(aux, exposed_full, exposure, config):
    """The auxiliary input of the network [b, A, H, W] or None: the images of clamped_aux, a light L as T(e L), and, at its place among them, the
    colour e H transformed as x is, by the albedo of its own resolution."""
    aux = with_lights(aux, lambda light: transform(exposure * finite(light), config.transfer), config)
    if not config.full:
        return aux
    images = list(aux.split(3, 1)) if config.guides else []
    images.insert(config.aux_inputs.index("colour"), transformed_colour(exposed_full, clamped_albedo(aux, config), config))
    return torch.cat(images, 1)


def channels_for(config):
    """How many channels own_aux needs of the images of a scene."""
    return 15 if config.first_lights else 9 if "depth" in config.guides else 6


def own_aux(image, config):
    """The auxiliary inputs of a model, but for the colour, out of albedo, normal, relative depth, diffuse and glossy light [..., 15, H, W], the
    first three [..., 9, H, W] or two [..., 6, H, W], in the model's order, the albedo clamped."""
    parts = {"albedo": image[..., :3, :, :].clamp(0, ALBEDO_MAX), "normal": image[..., 3:6, :, :]}
    if image.shape[-3] > 6:
        parts["depth"] = image[..., 6:9, :, :]
    if image.shape[-3] > 9:
        parts["diffuse"], parts["glossy"] = image[..., 9:12, :, :], image[..., 12:15, :, :]
    return torch.cat([parts[kind] for kind in config.guides], -3) if config.guides else image[..., :0, :, :]


def guides_of(aux, config):
    """What the guided base compares pixels by [b, 3 or 6, H, W]: albedo and, if there is one, normal, in units of their sigma."""
    guides = [clamped_albedo(aux, config) / SIGMA_ALBEDO]
    if "normal" in config.guides:
        first = 3 * config.guides.index("normal")
        guides.append(aux[:, first:first + 3] / SIGMA_NORMAL)
    return torch.cat(guides, 1)


def network_colour(exposed, albedo, config):
    """x [b, 3, h, w]: T(eI), or T(eI / (b + 0.02)) for the bases that demodulate, b the box mean of the albedo [b, 3, s*h, s*w]."""
    return transformed_colour(exposed, None if albedo is None else box_mean(albedo, config.scale), config)


def transformed_colour(exposed, albedo, config):
    """The same with an albedo of the colour's size."""
    return transform(demodulated(exposed, albedo, config), config.transfer)


def demodulated(exposed, albedo, config):
    """eI / (a + 0.02) for the bases that demodulate, eI for the others."""
    return exposed / (albedo + EPSILON) if config.base in ("demodulated", "guided") else exposed


def neighbours(x, side=5, step=1):
    """[b, c, h, w] -> [b, c, side^2, h, w]: the values around each pixel, `step` apart, row-major over (dy, dx), clamped at the border."""
    return inner_neighbours(F.pad(x, (side // 2 * step,) * 4, mode="replicate"), side, step)


def inner_neighbours(bordered, side=5, step=1):
    """The same of an image that has its border of side // 2 * step pixels already."""
    h, w = (extent - (side - 1) * step for extent in bordered.shape[-2:])
    return torch.stack([bordered[:, :, dy * step:dy * step + h, dx * step:dx * step + w] for dy in range(side) for dx in range(side)], 2)


def to_grid(x, scale):
    """[b, c, s*h, s*w] -> [b, h, w, s, s, c]: the high-resolution pixels of each low-resolution one."""
    b, c, height, width = x.shape
    return x.view(b, c, height // scale, scale, width // scale, scale).permute(0, 2, 4, 3, 5, 1).contiguous()


def from_grid(x):
    """Inverse of to_grid."""
    b, h, w, scale, _, c = x.shape
    return x.permute(0, 5, 1, 3, 2, 4).reshape(b, c, h * scale, w * scale)


def guided_log_weights(aux, config):
    """[b, h, w, s, s, 25] logarithms of the joint bilateral weights of auxiliary images [b, A, s*h, s*w].

    Values outside of the image are those of its border. round(q) is the low-resolution pixel that holds p, since q lies
    within half a pixel of it.
    """
    guides = guides_of(aux, config)
    return bilateral_log_weights(guides, neighbours(box_mean(guides, config.scale)), config.scale)


def bilateral_log_weights(guides, mean_neighbours, scale):
    """The same from guides [b, c, s*h, s*w] in units of their sigma and the neighbours of their box means [b, c, 25, h, w].

    The spatial term uses the neighbour's true position.
    """
    pixels, means = to_grid(guides, scale), mean_neighbours.permute(0, 3, 4, 1, 2).contiguous()[:, :, :, None, None]
    square = sum((pixels[..., k, None] - means[..., k, :]).square() for k in range(guides.shape[1]))
    offset = (torch.arange(scale, dtype=guides.dtype, device=guides.device) + 0.5) / scale - 0.5
    d = torch.arange(-2, 3, dtype=guides.dtype, device=guides.device)
    axis = (offset[:, None] - d).square() / (-2 * SIGMA_SPACE ** 2)                 # [s, 5]
    space = axis[:, None, :, None] + axis[None, :, None, :]                         # [s, s, 5, 5]
    return torch.log(torch.exp(-0.5 * square) + 1e-6) + space.reshape(scale, scale, 25)


def kernel_average(x_neighbours, log_weights):
    """Weighted mean of the 5 x 5 neighbours: [b, c, 25, h, w] and [b, h, w, s, s, 25] -> [b, c, s*h, s*w]."""
    b, h, w, scale, _, _ = log_weights.shape
    weights = torch.softmax(log_weights, -1).view(b * h * w, scale * scale, 25)
    values = x_neighbours.permute(0, 3, 4, 2, 1).reshape(b * h * w, 25, -1)
    return from_grid(torch.bmm(weights, values).view(b, h, w, scale, scale, -1))


def prefiltered(exposed, aux_mean, logits, config):
    """The low-resolution colour without most of its noise [b, 3, h, w], transformed: T(mean(e I) / (mean(b) + 0.02)).

    Both means have the same weights over the 25 taps of each level: 5 x 5 pixels, 3^k apart, of the images of level k, which is the mean of the
    3 x 3 pixels of the level below, 3^(k - 1) apart; level 0 are the images themselves. What lies outside of an image is its border. The
    logarithm of a weight is that of how alike the guides of the tap are to those of the pixel, as in the guided base, plus that of its distance
    in steps, plus a clamped logit [b, 25 levels, h, w]. exposed: e I [b, 3, h, w]; aux_mean: box means of the auxiliary images [b, A, h, w].
    """
    offset = torch.arange(-2, 3, dtype=aux_mean.dtype, device=aux_mean.device).square() / (-2 * SIGMA_PREFILTER ** 2)
    space = (offset[:, None] + offset[None, :]).view(1, 25, 1, 1)
    here, colours, albedos, log_weights = guides_of(aux_mean, config), [], [], []
    for level, learned in enumerate(logits.split(25, 1)):
        step = PREFILTER_STEP ** level
        if level:
            exposed, aux_mean = (neighbours(image, 3, step // PREFILTER_STEP).mean(2) for image in (exposed, aux_mean))
        colours.append(neighbours(exposed.clamp(min=0), step=step))
        albedos.append(neighbours(clamped_albedo(aux_mean, config), step=step))
        unlike = (neighbours(guides_of(aux_mean, config), step=step) - here[:, :, None]).square().sum(1)
        log_weights.append(torch.log(torch.exp(-0.5 * unlike) + 1e-6) + space + learned.clamp(-LOGIT_MAX, LOGIT_MAX))
    weights = torch.softmax(torch.cat(log_weights, 1), 1)
    colour, albedo = ((torch.cat(taps, 2) * weights[:, None]).sum(2) for taps in (colours, albedos))
    return transformed_colour(colour, albedo, config)


def base_image(x, aux, config, logits=None):
    """The base in the transformed domain [b, 3, H, W], or None for base=none. logits: [b, 25, H, W] learned kernels."""
    if config.base == "none":
        return None
    if config.base in ("bicubic", "demodulated"):
        return bicubic(x, config.scale)
    return kernel_average(neighbours(x), with_learned(guided_log_weights(aux, config), logits))


def with_learned(log_weights, logits):
    """Adds the clamped learned logits [b, 25, s*h, s*w], if any, to [b, h, w, s, s, 25]."""
    return log_weights if logits is None else log_weights + to_grid(logits, log_weights.shape[3]).clamp(-LOGIT_MAX, LOGIT_MAX)


def split_output(raw, config):
    """Raw output [b, output_width, H, W] -> (residual [b, 3, H, W], kernel logits, logits of the auxiliary images' kernels, logits of the
    full-resolution colour's kernel and of its share); None for what the model has not."""
    residual, *logits = raw.split(config.output_parts, 1)
    return residual, *(part if part.shape[1] else None for part in logits)


def filtered(aux_neighbours, logits):
    """Mean of the pixels around each, weighted by the softmax of the clamped logits: [b, c, m^2, H, W], [b, m^2, H, W] -> [b, c, H, W]."""
    weights = logits.clamp(-LOGIT_MAX, LOGIT_MAX).exp().contiguous()
    return (weights[:, None] * aux_neighbours).sum(2) / weights.sum(1, keepdim=True)


def blended(base, exposed_full, albedo, logits, config):
    """(1 - g) base + g Hf [b, 3, H, W]: g the sigmoid of the last of the logits [b, m^2 + 1, H, W], Hf = T(mean(e H) / (mean(a) + 0.02)) of the
    m x m pixels around each, weighted by the softmax of the others. The colour e H [b, 3, H, W] and its own albedo share their noise."""
    side = config.colour_kernels
    return blended_neighbours(base, neighbours(exposed_full, side), neighbours(albedo, side), logits, config)


def blended_neighbours(base, full_neighbours, albedo_neighbours, logits, config):
    """The same of the neighbours of both [b, 3, m^2, H, W]."""
    share, logits = torch.sigmoid(logits[:, -1:].clamp(-SHARE_LOGIT_MAX, SHARE_LOGIT_MAX)), logits[:, :-1]
    found = transformed_colour(filtered(full_neighbours, logits), filtered(albedo_neighbours, logits), config)
    return (1 - share) * base + share * found


def ceiling(x, config):
    """The most that the network may make of its surroundings [b, 3, h, w]: T(4 T^-1(m)), m the largest of the 5 x 5 x around, at least 0."""
    return inner_ceiling(F.pad(x, (CEILING_SIDE // 2,) * 4, mode="replicate"), config)


def inner_ceiling(bordered, config):
    """The same of an image that has its border of CEILING_SIDE // 2 pixels already."""
    largest = F.max_pool2d(bordered, CEILING_SIDE, 1).clamp(min=0)
    if config.transfer == "none":
        return CEILING_FACTOR * largest
    return largest + torch.log1p((CEILING_FACTOR - 1) * -torch.expm1(-largest))


def to_radiance(residual, base, ceiling, albedo, exposure, config):
    """Inverse of the pipeline: base (None: there is none) and residual, their sum clamped to 0 and the ceiling [b, 3, h, w] (or 11, if
    that is less), T^-1, times albedo for the bases that demodulate, over exposure."""
    transformed = residual
    if base is not None:  # the base itself is never clamped
        most = ceiling.clamp(max=TRANSFORMED_MAX).repeat_interleave(config.scale, 2).repeat_interleave(config.scale, 3)
        transformed = torch.minimum((base + residual).clamp(min=0), torch.maximum(base, most))
    radiance = inverse_transform(transformed, config.transfer)
    if config.base in ("demodulated", "guided"):
        radiance = radiance * (albedo + EPSILON)
    return radiance / exposure


def restrained(radiance, denoised, config):
    """What is taken of a result [b, 3, H, W] whose colour was denoised before: of the change in it the parts that the model states."""
    if config.denoised_darker == config.denoised_brighter == 100:
        return radiance
    denoised = denoised.clamp(min=0)
    change = radiance - denoised
    return denoised + (config.denoised_darker * change.clamp(max=0) + config.denoised_brighter * change.clamp(min=0)) / 100


def pad_inputs(x, aux, config):
    """Edge replication on the right and at the bottom to a multiple of the window (aux: to scale times that)."""
    def pad(image, multiple):
        height, width = image.shape[-2:]
        return F.pad(image, (0, -width % multiple, 0, -height % multiple), mode="replicate")
    return pad(x, config.window), None if aux is None else pad(aux, config.window * config.scale)


def baseline(colour, aux, config, exposure=None):
    """What a network of zeros would give: the base alone, as radiance [b, 3, H, W]; bicubic where a model has none."""
    if config.base == "none":
        config = dataclasses.replace(config, base="bicubic")
    exposure = auto_exposure(colour[0]) if exposure is None else exposure
    albedo = clamped_albedo(aux, config)
    x = network_colour(colour * exposure, albedo, config)
    base = base_image(x, aux, config)
    return to_radiance(torch.zeros_like(base), base, ceiling(x, config), albedo, exposure, config)


def upscale(network, colour, aux=None, exposure=None, full=None):
    """Runs a model on one image: colour [1, 3, h, w], aux [1, 3 guides, s*h, s*w] and, for a model that takes it, the full-resolution
    colour [1, 3, s*h, s*w] -> (radiance [1, 3, H, W], raw output [1, output_width, H, W], exposure). Such a model expects a merged colour.
    """
    config = network.config
    exposure = auto_exposure(colour[0]) if exposure is None else exposure
    result, raw, _ = exposed_result(network, config, colour * exposure, aux, full * exposure if config.full else None, exposure)
    return result / exposure, raw, exposure


def exposed_result(network, config, exposed, aux, exposed_full, exposure):
    """(exposed radiance [b, 3, H, W], raw output, filtered auxiliary images) of colours times their exposure; network: (x, aux) -> (raw,
    prefilter logits).

    With aux_kernels, base image and output are made of the filtered auxiliary images, demodulation included; the network sees the unfiltered.
    """
    aux, exposed_full = clamped_aux(aux, config), finite(exposed_full) if config.full else None
    noisy = aux
    x = network_colour(exposed, clamped_albedo(aux, config), config)
    height, width = x.shape[-2:]
    raw, prefilter_logits = network(*pad_inputs(x, network_aux(aux, exposed_full, exposure, config), config))
    raw = raw[:, :, :height * config.scale, :width * config.scale]
    residual, logits, aux_logits, colour_logits = split_output(raw, config)
    most = None
    if prefilter_logits is not None:
        most = ceiling(x, config)
        x = prefiltered(exposed, box_mean(aux, config.scale), prefilter_logits[:, :, :height, :width], config)
    if aux_logits is not None:
        aux = filtered(neighbours(aux, config.aux_kernels), aux_logits)
        x = x if config.prefilter else network_colour(exposed, clamped_albedo(aux, config), config)
    base = base_image(x, aux, config, logits)
    if colour_logits is not None:
        base = blended(base, exposed_full, clamped_albedo(noisy, config), colour_logits, config)
    return to_radiance(residual, base, ceiling(x, config) if most is None else most, clamped_albedo(aux, config), 1.0, config), raw, aux
