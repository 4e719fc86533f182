//! Which passes have to run again, when some of what they read has changed.

use crate::uses::Use;

/// What is known of a frame's passes from one rendering to the next. Asking it takes no memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reuse {
    /// Of every pass, what it does to each memory (textures may share one).
    uses: Vec<Vec<Use>>,
    /// Of every memory, the last pass of a frame that changes it.
    last: Vec<Option<usize>>,
    /// Passes that read what the last frame left.
    looks_back: Vec<bool>,
    /// Passes whose own inputs have changed since they ran.
    stale: Vec<bool>,
    run: Vec<bool>,
    /// Scratch: of every memory, whether what is there differs from the last frame's.
    differs: Vec<bool>,
    /// Scratch: of every memory, the last pass so far that changes it.
    before: Vec<Option<usize>>,
}

impl Reuse {
    /// `uses` name memories by numbers below `memories`.
    pub fn new(uses: Vec<Vec<Use>>, looks_back: Vec<bool>, memories: usize) -> Self {
        let mut last = vec![None; memories];
        for (index, pass) in uses.iter().enumerate() {
            for used in pass.iter().filter(|used| used.changes) {
                last[used.resource] = Some(index);
            }
        }
        let count = uses.len();
        Self {
            uses,
            last,
            looks_back,
            stale: vec![true; count],
            run: vec![false; count],
            differs: vec![false; memories],
            before: vec![None; memories],
        }
    }

    /// That something a pass reads has changed, beside what passes write.
    pub fn touch(&mut self, pass: usize) {
        self.stale[pass] = true;
    }

    /// That all passes have run.
    pub fn done(&mut self) {
        self.stale.fill(false);
    }

    /// That nothing is known of what the memories hold.
    pub fn forget(&mut self) {
        self.stale.fill(true);
    }

    /// What [`Self::passes`] told last.
    pub fn chosen(&self) -> &[bool] {
        &self.run
    }

    /// The passes to run so that everything is as if all ran.
    ///
    /// A pass runs if what it reads has changed; so do those that make what it reads anew, if that
    /// has been overwritten since, and those that later write to what it writes.
    pub fn passes(&mut self) -> &[bool] {
        self.differs.fill(false);
        for (index, pass) in self.uses.iter().enumerate() {
            let reads_other = pass.iter().any(|u| u.needs && self.differs[u.resource]);
            self.run[index] = self.stale[index] || self.looks_back[index] || reads_other;
            for used in pass.iter().filter(|used| used.changes) {
                if self.run[index] {
                    self.differs[used.resource] = true;
                } else if !used.needs {
                    self.differs[used.resource] = false;
                }
            }
        }
        while self.complete() {}
        &self.run
    }

    /// Adds what the passes that run demand; whether there was any.
    fn complete(&mut self) -> bool {
        let mut added = false;
        self.before.fill(None);
        // Later writers of what is written anew.
        self.differs.fill(false);
        for (index, pass) in self.uses.iter().enumerate() {
            if !self.run[index] && pass.iter().any(|u| u.changes && self.differs[u.resource]) {
                self.run[index] = true;
                added = true;
            }
            for used in pass {
                // Makers of what is read and no longer there.
                if let Some(maker) = self.before[used.resource]
                    && used.needs
                    && self.run[index]
                    && !self.run[maker]
                    && self.last[used.resource] != Some(maker)
                {
                    self.run[maker] = true;
                    added = true;
                }
            }
            for used in pass.iter().filter(|used| used.changes) {
                self.before[used.resource] = Some(index);
                self.differs[used.resource] |= self.run[index];
            }
        }
        added
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const READ: (bool, bool) = (true, false);
    const WRITE: (bool, bool) = (false, true);
    const ADD: (bool, bool) = (true, true);

    /// Passes by what they do to memories.
    fn reuse(passes: &[&[(usize, (bool, bool))]]) -> Reuse {
        let uses: Vec<Vec<Use>> = passes
            .iter()
            .map(|pass| {
                let one = |&(resource, (needs, changes)): &(usize, (bool, bool))| Use {
                    resource,
                    needs,
                    changes,
                };
                pass.iter().map(one).collect()
            })
            .collect();
        let memories = uses.iter().flatten().map(|u| u.resource + 1).max();
        let looks_back = vec![false; uses.len()];
        Reuse::new(uses, looks_back, memories.unwrap_or(0))
    }

    fn run(reuse: &mut Reuse, touched: &[usize]) -> Vec<usize> {
        reuse.done();
        for &pass in touched {
            reuse.touch(pass);
        }
        let run = reuse.passes().iter().enumerate();
        run.filter(|(_, run)| **run).map(|(i, _)| i).collect()
    }

    /// Near writes the frame (0) and depth (1), broad the seen buffer (2), narrow adds to the frame.
    fn refraction() -> Reuse {
        reuse(&[
            &[(0, WRITE), (1, WRITE)],
            &[(2, WRITE)],
            &[(0, ADD), (1, READ), (2, READ)],
        ])
    }

    #[test]
    fn everything_runs_at_first_and_nothing_where_nothing_changes() {
        let mut frame = refraction();
        assert_eq!(frame.passes(), [true; 3]);
        assert!(run(&mut frame, &[]).is_empty());
    }

    #[test]
    fn what_was_drawn_over_is_drawn_again_and_the_seen_buffer_stays() {
        assert_eq!(run(&mut refraction(), &[2]), [0, 2]);
    }

    #[test]
    fn what_is_drawn_anew_is_drawn_over_again() {
        assert_eq!(run(&mut refraction(), &[0]), [0, 2]);
        assert_eq!(run(&mut refraction(), &[1]), [0, 1, 2]);
    }

    #[test]
    fn what_lies_apart_stays() {
        let mut frame = reuse(&[&[(0, WRITE)], &[(1, WRITE)], &[(0, READ), (2, WRITE)]]);
        assert_eq!(run(&mut frame, &[0]), [0, 2]);
        assert_eq!(run(&mut frame, &[1]), [1]);
        assert_eq!(run(&mut frame, &[2]), [2]);
    }

    #[test]
    fn memory_that_another_texture_took_over_is_filled_anew() {
        // 0 is one texture for the first two passes and another for the last two.
        let mut frame = reuse(&[
            &[(0, WRITE)],
            &[(0, READ), (1, WRITE)],
            &[(0, WRITE)],
            &[(0, READ), (2, WRITE)],
        ]);
        assert_eq!(run(&mut frame, &[1]), [0, 1, 2]);
        assert_eq!(run(&mut frame, &[3]), [3]);
        assert_eq!(run(&mut frame, &[2]), [2, 3]);
    }

    #[test]
    fn what_reads_the_last_frame_always_runs() {
        let uses = refraction().uses;
        let mut frame = Reuse::new(uses, vec![false, false, true], 3);
        assert_eq!(run(&mut frame, &[]), [0, 2]);
    }

    /// Simulates memories as sets of what went into them; partial runs must end as whole ones do.
    #[test]
    fn a_partial_run_leaves_what_a_whole_one_would() {
        let mut state = 7_u64;
        let mut random = move |below: u64| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 33) % below
        };
        let mut saved = 0;
        for _ in 0..3000 {
            let memories = 1 + random(4) as usize;
            let count = 1 + random(6) as usize;
            let mut written = vec![false; memories];
            let mut uses: Vec<Vec<Use>> = Vec::new();
            for _ in 0..count {
                let mut pass = Vec::new();
                for (resource, written) in written.iter_mut().enumerate() {
                    let (needs, changes) = [READ, WRITE, ADD][random(3) as usize];
                    if random(2) == 0 {
                        // What nobody has written yet is cleared first.
                        let first = !std::mem::replace(written, true);
                        pass.push(Use {
                            resource,
                            needs: needs && !first,
                            changes: changes || first,
                        });
                    }
                }
                uses.push(pass);
            }
            let mut own: Vec<u64> = (0..count as u64).collect();
            let mut memory = vec![0_u64; memories];
            let all = vec![true; count];
            simulate(&uses, &own, &all, &mut memory);
            let mut frame = Reuse::new(uses.clone(), vec![false; count], memories);
            frame.done();
            for _ in 0..3 {
                for (pass, own) in own.iter_mut().enumerate() {
                    if random(4) == 0 {
                        *own += 1000;
                        frame.touch(pass);
                    }
                }
                let run = frame.passes().to_vec();
                saved += run.iter().filter(|run| !**run).count();
                simulate(&uses, &own, &run, &mut memory);
                frame.done();
                let mut whole = vec![0_u64; memories];
                simulate(&uses, &own, &all, &mut whole);
                assert_eq!(memory, whole, "{uses:?} {run:?}");
            }
        }
        assert!(saved > 5000, "{saved}");
    }

    fn simulate(uses: &[Vec<Use>], own: &[u64], run: &[bool], memory: &mut [u64]) {
        for (index, pass) in uses.iter().enumerate().filter(|(index, _)| run[*index]) {
            let mut made = own[index].wrapping_mul(0x9e37_79b9_7f4a_7c15);
            for used in pass.iter().filter(|used| used.needs) {
                made = (made ^ memory[used.resource]).wrapping_mul(0x100_0000_01b3) + 1;
            }
            for used in pass.iter().filter(|used| used.changes) {
                memory[used.resource] = made + used.resource as u64;
            }
        }
    }
}
