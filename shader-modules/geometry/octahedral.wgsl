// Unit vectors as two numbers in [−1, 1].
// Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors", the
// octahedral map. The zero vector becomes (0, 0, 1).
//
// domain: octahedral_encoded(v unit)
// domain: octahedral_decoded(e -1 to 1)

// Signs, with 1 for zero.
fn octahedral_signs(v: vec2f) -> vec2f {
    return select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

fn octahedral_encoded(v: vec3f) -> vec2f {
    let sum = max(abs(v.x) + abs(v.y) + abs(v.z), 1e-20);
    // 1 − |y| / sum, written so that nothing cancels; and likewise for the other.
    let folded = (abs(v.xy) + abs(v.z)) * octahedral_signs(v.xy);
    return select(v.xy, folded, v.z < 0.0) / sum;
}

fn octahedral_decoded(e: vec2f) -> vec3f {
    let height = 1.0 - abs(e.x) - abs(e.y);
    let unfolded = e - octahedral_signs(e) * max(-height, 0.0);
    return normalize(vec3f(unfolded, height));
}
