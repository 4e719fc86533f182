//! Which textures can share memory: those of one kind that are never needed at once.

/// A texture of a plan, by what decides on its memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wanted<K> {
    /// Textures of different kinds (format, size, usage) share nothing.
    pub kind: K,
    /// The first and the last pass that touch it; none where it is to have memory of its own.
    pub life: Option<[usize; 2]>,
}

/// The memory of each texture, numbered from 0. A memory's first texture is the first of its kind.
pub(crate) fn memories<K: PartialEq>(wanted: &[Wanted<K>]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by_key(|&index| wanted[index].life.map(|[first, _]| first));
    // Of every memory, a texture that has it, and the last pass that touches one.
    let mut made: Vec<(usize, Option<usize>)> = Vec::new();
    let mut memory = vec![0; wanted.len()];
    for index in order {
        let texture = &wanted[index];
        let free = texture.life.and_then(|[first, _]| {
            let mut known = made.iter();
            known.position(|(of, last)| {
                wanted[*of].kind == texture.kind && last.is_some_and(|last| last < first)
            })
        });
        let last = texture.life.map(|[_, last]| last);
        memory[index] = match free {
            Some(free) => {
                made[free].1 = last;
                free
            }
            None => {
                made.push((index, last));
                made.len() - 1
            }
        };
    }
    memory
}

/// The most bytes that are needed at once; a texture of no known life always is.
pub(crate) fn peak(textures: &[(u64, Option<[usize; 2]>)]) -> u64 {
    let at = |pass: usize| {
        let needed = |(bytes, life): &(u64, Option<[usize; 2]>)| match life {
            Some([first, last]) if !(*first..=*last).contains(&pass) => 0,
            _ => *bytes,
        };
        textures.iter().map(needed).sum()
    };
    let firsts = textures.iter().filter_map(|(_, life)| life.map(|l| l[0]));
    firsts.chain([0]).map(at).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wanted(kind: u8, life: Option<[usize; 2]>) -> Wanted<u8> {
        Wanted { kind, life }
    }

    #[test]
    fn what_is_not_needed_at_once_shares() {
        let textures = [
            wanted(0, Some([0, 1])),
            wanted(0, Some([1, 2])),
            wanted(0, Some([2, 3])),
            wanted(1, Some([2, 3])),
            wanted(0, None),
            wanted(0, Some([4, 4])),
        ];
        let memory = memories(&textures);
        assert_eq!(memory[0], memory[2]);
        assert!(memory[5] == memory[0] || memory[5] == memory[1]);
        let mut distinct = memory.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), 4, "{memory:?}");
    }

    #[test]
    fn no_two_that_live_at_once_share_and_kinds_never_do() {
        let mut state = 3_u64;
        let mut random = move |below: u64| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 33) % below
        };
        let mut shared = 0;
        for _ in 0..500 {
            let count = random(12) as usize;
            let textures: Vec<Wanted<u8>> = (0..count)
                .map(|_| {
                    let first = random(8) as usize;
                    let life = [first, first + random(4) as usize];
                    wanted(random(2) as u8, (random(5) > 0).then_some(life))
                })
                .collect();
            let memory = memories(&textures);
            for i in 0..count {
                for j in 0..i {
                    if memory[i] != memory[j] {
                        continue;
                    }
                    shared += 1;
                    assert_eq!(textures[i].kind, textures[j].kind);
                    let (Some(a), Some(b)) = (textures[i].life, textures[j].life) else {
                        panic!("one has no known life");
                    };
                    assert!(a[1] < b[0] || b[1] < a[0], "{a:?} {b:?}");
                }
            }
        }
        assert!(shared > 100, "{shared}");
    }

    #[test]
    fn the_peak_is_what_the_fullest_pass_needs() {
        let textures = [
            (1, Some([0, 1])),
            (10, Some([1, 2])),
            (100, Some([3, 3])),
            (1000, None),
        ];
        assert_eq!(peak(&textures), 1100);
        assert_eq!(peak(&textures[..2]), 11);
        assert_eq!(peak(&[]), 0);
    }
}
