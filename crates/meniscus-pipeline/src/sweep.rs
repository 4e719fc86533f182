//! What nobody needs: lists that stay empty, and what is made for nobody.

use std::collections::BTreeSet;

use crate::plan::{Plan, PlannedPass};
use crate::rules::{Dropped, Rule};

/// The variable of a list's pixels in an entry point.
pub(crate) const PIXELS: &str = "pass_pixels";

/// Leaves out what cannot do anything and what nobody reads, until there is no more of it.
pub(crate) fn sweep(plan: &mut Plan, dropped: &mut Vec<Dropped>) {
    loop {
        let before = dropped.len();
        for needless in [empty_lists, unread] {
            let gone = needless(plan);
            let stays = |name: &str| gone.iter().all(|gone| gone.pass != name);
            plan.passes.retain(|pass| stays(&pass.name));
            dropped.extend(gone);
        }
        if dropped.len() == before {
            break;
        }
    }
    let used: BTreeSet<String> = plan
        .passes
        .iter()
        .map(|pass| plan.uses(pass))
        .flat_map(|uses| uses.reads.into_iter().chain(uses.writes))
        .chain([plan.output.as_str()])
        .chain(plan.shown.as_deref())
        .map(str::to_owned)
        .collect();
    plan.textures.retain(|name, _| used.contains(name));
    plan.buffers.retain(|name, _| used.contains(name));
}

/// Passes over lists that no other pass writes: they hold zeros.
fn empty_lists(plan: &Plan) -> Vec<Dropped> {
    let written_by_others = |pass: &PlannedPass, buffer: &str| {
        let others = plan.passes.iter().filter(|other| other.name != pass.name);
        others
            .map(|other| plan.uses(other))
            .any(|uses| uses.writes.contains(buffer))
    };
    let never_filled = |pass: &&PlannedPass| {
        let mut bindings = pass.shader.bindings.iter();
        let pixels = bindings.find(|binding| binding.variable == PIXELS)?;
        (!written_by_others(pass, &pixels.resource)).then(|| pixels.resource.clone())
    };
    let dropped = |pass: &PlannedPass| {
        let list = never_filled(&pass)?;
        let because = format!("no pass adds to `{list}`");
        Some(Dropped::exactly(&pass.name, Rule::EmptyList, because))
    };
    plan.passes.iter().filter_map(dropped).collect()
}

/// Passes that write nothing which anybody reads. Textures are cleared in every frame, so that only
/// later passes read what is written; buffers may be read in the next frame, by any pass.
fn unread(plan: &Plan) -> Vec<Dropped> {
    let uses: Vec<_> = plan.passes.iter().map(|pass| plan.uses(pass)).collect();
    let mut buffers: BTreeSet<&str> = plan.lists.values().map(String::as_str).collect();
    let mut live = vec![false; uses.len()];
    loop {
        let before = buffers.len();
        let mut textures: BTreeSet<&str> = [plan.output.as_str()].into();
        textures.extend(plan.shown.as_deref());
        for (index, uses) in uses.iter().enumerate().rev() {
            let wanted = |name: &&str| textures.contains(name) || buffers.contains(name);
            live[index] = uses.writes.iter().any(wanted);
            if live[index] {
                let (read_buffers, read_textures): (Vec<&str>, Vec<&str>) = uses
                    .reads
                    .iter()
                    .partition(|name| plan.buffers.contains_key(**name));
                buffers.extend(read_buffers);
                textures.extend(read_textures);
            }
        }
        if buffers.len() == before {
            break;
        }
    }
    let dead = plan.passes.iter().zip(&uses).zip(live);
    dead.filter(|(_, live)| !live)
        .map(|((pass, uses), _)| {
            let names: Vec<String> = uses.writes.iter().map(|name| format!("`{name}`")).collect();
            let because = match names.is_empty() {
                true => "it writes nothing".to_owned(),
                false => format!("nobody reads {}", names.join(", ")),
            };
            Dropped::exactly(&pass.name, Rule::Unread, because)
        })
        .collect()
}
