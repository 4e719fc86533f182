//! Names that WGSL declares itself. A shader's own items never get them: an item of that name in
//! one module would change what the word means in all others.

/// Functions, and words that stand in template lists and attributes; types are keywords to naga.
const PREDECLARED: &[&str] = &[
    "abs", "acos", "acosh", "all", "any", "arrayLength", "asin", "asinh", "atan", "atan2", "atanh",
    "atomicAdd", "atomicAnd", "atomicCompareExchangeWeak", "atomicExchange", "atomicLoad", "atomicMax",
    "atomicMin", "atomicOr", "atomicStore", "atomicSub", "atomicXor", "bitcast", "ceil", "clamp", "cos",
    "cosh", "countLeadingZeros", "countOneBits", "countTrailingZeros", "cross", "degrees", "determinant",
    "distance", "dot", "dot4I8Packed", "dot4U8Packed", "dpdx", "dpdxCoarse", "dpdxFine", "dpdy",
    "dpdyCoarse", "dpdyFine", "exp", "exp2", "extractBits", "faceForward", "firstLeadingBit",
    "firstTrailingBit", "floor", "fma", "fract", "frexp", "fwidth", "fwidthCoarse", "fwidthFine",
    "insertBits", "inverse", "inverseSqrt", "ldexp", "length", "log", "log2", "max", "min", "mix", "modf",
    "normalize", "outerProduct", "pack2x16float", "pack2x16snorm", "pack2x16unorm", "pack4x8snorm",
    "pack4x8unorm", "pack4xI8", "pack4xI8Clamp", "pack4xU8", "pack4xU8Clamp", "pow", "quantizeToF16",
    "quadBroadcast", "quadSwapDiagonal", "quadSwapX", "quadSwapY", "radians", "reflect", "refract",
    "reverseBits", "round", "saturate", "select", "sign", "sin", "sinh", "smoothstep", "sqrt", "step",
    "storageBarrier", "subgroupAdd", "subgroupAll", "subgroupAnd", "subgroupAny", "subgroupBallot",
    "subgroupBarrier", "subgroupBroadcast", "subgroupBroadcastFirst", "subgroupElect",
    "subgroupExclusiveAdd", "subgroupExclusiveMul", "subgroupInclusiveAdd", "subgroupInclusiveMul",
    "subgroupMax", "subgroupMin", "subgroupMul", "subgroupOr", "subgroupShuffle", "subgroupShuffleDown",
    "subgroupShuffleUp", "subgroupShuffleXor", "subgroupXor", "tan", "tanh", "textureBarrier",
    "textureDimensions", "textureGather", "textureGatherCompare", "textureLoad", "textureNumLayers",
    "textureNumLevels", "textureNumSamples", "textureSample", "textureSampleBaseClampToEdge",
    "textureSampleBias", "textureSampleCompare", "textureSampleCompareLevel", "textureSampleGrad",
    "textureSampleLevel", "textureStore", "transpose", "trunc", "unpack2x16float", "unpack2x16snorm",
    "unpack2x16unorm", "unpack4x8snorm", "unpack4x8unorm", "unpack4xI8", "unpack4xU8", "workgroupBarrier",
    "workgroupUniformLoad", "function", "handle", "private", "read", "read_write", "storage", "uniform",
    "workgroup", "write",
];

/// Names of the entry points and of what is written beside them.
const ENTRY: &[&str] = &[
    "vertex_main", "fragment_main", "compute_main", "PassOutputs", "PassPixels", "PassVarying", "pass_pixels",
];

/// Whether WGSL declares a name itself.
pub(crate) fn is_predeclared(name: &str) -> bool {
    PREDECLARED.contains(&name)
}

/// Whether the composer declares a name in every shader of some kind.
pub(crate) fn is_entry(name: &str) -> bool {
    ENTRY.contains(&name)
}
