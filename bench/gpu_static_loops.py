"""Reads the machine code that the compilers of RADV, NVK and ANV print: which instructions a kernel, or its inner loop, has."""
import collections
import re

# Vector instructions that a product of matrix units takes as long as, on RDNA3 and RDNA4: 8192 products in 32 cycles of
# a SIMD, where a vector instruction of 64 invocations takes 2.
VECTORS_A_PRODUCT = 16

KINDS = (
    ("products", r"v_(s?wmma|mfma)"),
    ("multiplyAdds", r"v_(pk_|dual_)?(fma|fmac|mac|mad|fmamk|fmaak|madmk|madak|dot2)"),
    ("vector", r"v_"),
    ("sharedLoads", r"ds_(load|read)"),
    ("sharedStores", r"ds_"),
    ("loads", r"(buffer|global|flat|tbuffer|image)_(load|gather)"),
    ("stores", r"(buffer|global|flat|tbuffer|image)_store"),
    ("scratch", r"scratch_"),
    ("waits", r"s_wait"),
    ("barriers", r"s_barrier"),
    ("scalar", r"s_"),
)


def kind(operation):
    return next((name for name, pattern in KINDS if re.match(pattern, operation)), "other")


def is_gather16(operation):
    """A load of 16 bits, of which a matrix fragment then needs one for each of its elements."""
    return re.match(r"(ds|buffer|global|flat|scratch)_(load|read)_.*(u16|d16|i16|short)", operation) is not None


def blocks(assembly):
    """[(label, [(operation, operands)])] in order."""
    found = [("BB0", [])]
    for line in assembly.splitlines():
        if label := re.match(r"(BB\d+):", line):
            found.append((label[1], []))
        elif instruction := re.match(r"\s+([a-z]\w+)\s*(.*)", line):
            found[-1][1].append((instruction[1], instruction[2]))
    return found


def loops(assembly):
    """The operations of every loop: of all blocks from where a branch goes back to, to the branch."""
    found = blocks(assembly)
    places = {label: i for i, (label, _) in enumerate(found)}
    for last, (_, instructions) in enumerate(found):
        for operation, operands in instructions:
            target = re.search(r"BB\d+", operands) if "branch" in operation else None
            if target and places.get(target[0], last + 1) <= last:
                yield [each for _, block in found[places[target[0]]:last + 1] for each, _ in block]


def counted(operations):
    return collections.Counter(map(kind, operations))


def inner_loop(assembly):
    """The counts of the loop that is densest in products, with `gathers16` and `productShare`, the share of vector time
    that is spent on products; None if no loop has any. Where the products of matrix units stand in no loop, for all are unrolled, of the whole."""
    best, best_density = None, 0
    candidates, whole = list(loops(assembly)), [operation for _, block in blocks(assembly) for operation, _ in block]
    if counted(whole)["products"] and not any(counted(operations)["products"] for operations in candidates):
        candidates = [whole]
    for operations in candidates:
        counts = counted(operations)
        useful = VECTORS_A_PRODUCT * counts["products"] + counts["multiplyAdds"]
        if useful / len(operations) <= best_density:
            continue
        best_density = useful / len(operations)
        best = {name: counts[name] for name, _ in KINDS if counts[name]}
        best["all"] = len(operations)
        best["gathers16"] = sum(map(is_gather16, operations))
        best["productShare"] = round(useful / (useful + counts["vector"]), 3)
    return best


# Of NVIDIA, as NAK prints them: "r4..8 = hmma.m16n8k16.f32 r0..4 r8..10 r4..8".
NAK_KINDS = (
    ("products", r"hmma"),
    ("multiplyAdds", r"ffma|hfma2"),
    ("sharedLoads", r"ld\.shared|ldsm"),
    ("sharedStores", r"st\.shared"),
    ("scratch", r"(ld|st)\.local"),
    ("loads", r"ld\.global|tld|tex"),
    ("stores", r"st\.global"),
    ("barriers", r"bar\."),
)


def whole_program(assembly):
    """The counts of all that NAK prints of a program, with `gathers16` as above; None if nothing is printed."""
    counts, gathers, every = collections.Counter(), 0, 0
    for line in assembly.splitlines():
        instruction = re.match(r"\s+(?:[^=/]*= )?(?:@\S+ )?([a-z]\w*(?:\.\w+)*)", line.split("//")[0])
        if not instruction:
            continue
        every += 1
        name = next((name for name, pattern in NAK_KINDS if re.match(pattern, instruction[1])), None)
        counts[name] += 1
        gathers += re.match(r"ld\.(shared|global).*\.[usb]16", instruction[1]) is not None
    del counts[None]
    return {**counts, "all": every, "gathers16": gathers} if every else None


# Of Intel: "(+f0.0) mad(8)  g29<1>F ...".
GEN_KINDS = (("products", r"dpas"), ("multiplyAdds", r"mad|mac"), ("barriers", r"barrier"))


def whole_gen_program(assembly):
    """The counts of all that ANV prints of a program; None if nothing is printed."""
    operations = re.findall(r"^\s*(?:\([^)]*\)\s+)?([a-z]\w*(?:\.\w+)*)\s*\(\d+\)", assembly, re.M)
    counts = collections.Counter(name for operation in operations for name, pattern in GEN_KINDS if re.match(pattern, operation))
    return {**counts, "all": len(operations)} if operations else None
