//! What a module may not do, so that it runs in every stage, and on the CPU.

use meniscus_source::{Diagnostic, Report};

use crate::lexer::Kind;
use crate::library::{Module, Role};
use crate::outline::ItemKind;

impl Module {
    /// Everything but a skeleton must run in every stage and without effects; bindings are the
    /// composer's.
    pub(crate) fn check_purity(&self, report: &mut Report) {
        let text = &self.file.text;
        let tokens = &self.outline.tokens;
        for (index, token) in tokens.iter().enumerate() {
            // Nearly all words begin otherwise than those that are looked for.
            let first = text.as_bytes()[token.range.start];
            if token.kind != Kind::Word || !b"abdfgstw".contains(&first) {
                continue;
            }
            let word = &text[token.range.clone()];
            let before = index.checked_sub(1).map(|i| tokens[i].kind);
            if before == Some(Kind::Mark('@')) && matches!(word, "group" | "binding") {
                report.add(
                    Diagnostic::error(format!("`{}` writes a binding by hand", self.path))
                        .at(&self.place(token.range.clone()), "not in a module")
                        .with_help("leave @group and @binding out: the composer assigns them"),
                );
            }
            if self.role() == Role::Skeleton || before == Some(Kind::Mark('.')) {
                continue;
            }
            let called = tokens.get(index + 1).map(|t| t.kind) == Some(Kind::Mark('('));
            if let Some((why, instead)) = impurity(word, called) {
                report.add(
                    Diagnostic::error(format!("`{}` is not pure: {why}", self.path))
                        .at(&self.place(token.range.clone()), "not in a module")
                        .with_help(instead),
                );
            }
        }
        if self.role() == Role::Skeleton {
            return;
        }
        for item in &self.outline.items {
            if let ItemKind::Variable { space, .. } = &item.kind
                && !matches!(space.as_str(), "" | "uniform" | "storage" | "storage,read")
            {
                report.add(
                    Diagnostic::error(format!(
                        "`{}` is not pure: `{}` can be written",
                        self.path, item.name
                    ))
                    .at(&self.place(item.name_range.clone()), format!("in `{space}`"))
                    .with_help("a module reads uniforms, read-only storage and textures; only a skeleton writes"),
                );
            }
        }
    }
}

/// Why a word makes a module impure, and what to do instead.
fn impurity(word: &str, called: bool) -> Option<(&'static str, &'static str)> {
    match word {
        "discard" => Some((
            "it discards fragments",
            "return a flag that the skeleton's `keep` looks at",
        )),
        _ if !called => None,
        "dpdx" | "dpdy" | "dpdxCoarse" | "dpdyCoarse" | "dpdxFine" | "dpdyFine" | "fwidth"
        | "fwidthCoarse" | "fwidthFine" => Some((
            "derivatives exist in fragment shaders alone",
            "pass the footprint as an argument",
        )),
        "textureSample" | "textureSampleBias" | "textureSampleCompare" => Some((
            "it samples with an implicit level of detail, which fragment shaders alone can",
            "use textureSampleLevel or textureLoad",
        )),
        "textureStore" => Some((
            "it writes a texture",
            "return the value; the pass writes it",
        )),
        "workgroupBarrier" | "storageBarrier" | "textureBarrier" | "workgroupUniformLoad" => {
            Some(("it synchronises threads", "only a compute skeleton can"))
        }
        _ if word.starts_with("atomic") => {
            Some(("it writes memory", "only a compute skeleton can"))
        }
        _ => None,
    }
}
