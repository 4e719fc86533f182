// Repeats a tap where the last one led, and keeps the one with the smallest residual.
// Taps at the edges of objects swing to and fro, so the last is not always the best. A tap that is
// good enough is not repeated. World space, metres; residuals in pixels of the seen buffers.
//
// provides: intersect
// needs: geometry/ray, geometry/hit
// slots: tap: intersect
// number taps: 1 to 8, step 1
// number enough_px: 0 to 64 px, step 0.01
// domain: intersect(texel -100 to 1e4)
// identity when not waves: exactly

override taps: i32 = 2;
override enough_px: f32 = 0.01;

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    var best: Hit;
    var place = texel;
    for (var i = 0; i < taps; i++) {
        let last = tap(ray, place);
        place = last.texel;
        if i == 0 || last.residual < best.residual {
            best = last;
        }
        if best.residual <= enough_px {
            break;
        }
    }
    return best;
}
