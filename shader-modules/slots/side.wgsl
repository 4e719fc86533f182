// Whether a point belongs to what a pass draws. World space, metres. By default everything does.

fn side(point: vec3f) -> bool {
    return true;
}
