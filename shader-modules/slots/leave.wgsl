// Where a ray that starts on the water meets the water again, on its way along either side.
// World space, metres. By default, on the rest plane, it does not.
//
// needs: geometry/ray, water/meeting
// when displaced: water/leaves_waves

fn leave(ray: Ray) -> Meeting {
    return Meeting(vec3f(0.0), vec3f(0.0, 0.0, 1.0), false);
}
