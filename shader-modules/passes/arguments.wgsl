// Turns the length of a list into the arguments of an indirect dispatch over it.
// Workgroups of 64 threads; along one axis there are at most 65,535 of them, so that long lists are
// folded into rows.
//
// skeleton: compute
// workgroup: 1

struct Counted {
    count: u32,
    pixels: array<u32>,
}

var<storage, read> counted: Counted;
var<storage, read_write> arguments: array<u32, 3>;

fn compute(thread: vec3u) {
    let count = min(counted.count, arrayLength(&counted.pixels));
    let groups = (count + 63u) / 64u;
    let columns = min(groups, 65535u);
    arguments[0] = columns;
    arguments[1] = (groups + 65534u) / 65535u;
    arguments[2] = 1u;
}
