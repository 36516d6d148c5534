//! The text of a class with that of its interfaces, for people.

use super::TypedProgram;
use super::lineage::{levels, parameters};
use super::types::Type;
use crate::program::DefinitionId;
use eng_grammar::Span;
use eng_grammar::ast::ItemKind;

/// A class as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassText {
    /// Its interfaces, the eldest first, then the class itself.
    pub levels: Vec<LevelText>,
    /// Its parameters that are single markers, in their order.
    pub markers: Vec<String>,
}

/// The definition of a class or an interface.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelText {
    /// Its name.
    pub name: String,
    /// The lines of its comment.
    pub docs: Vec<String>,
    /// Its place, without the comment.
    pub span: Span,
}

impl TypedProgram {
    /// The class whose name is at a place.
    pub fn class_at(&self, name: Span) -> Option<ClassText> {
        let definitions = (0..).zip(&self.program.modules);
        let definition = definitions
            .flat_map(|(module, file)| (0..).zip(&file.file.items).map(move |item| (module, item)))
            .find_map(|(module, (item, found))| match &found.kind {
                ItemKind::Declaration(declaration) if declaration.name.span == name => {
                    Some(DefinitionId { module, item })
                }
                _ => None,
            })?;
        let texts = levels(&self.program, definition);
        let texts = texts.into_iter().filter_map(|level| {
            let item = self.program.item(level.definition)?;
            Some(LevelText {
                name: level.declaration.name.text.clone(),
                docs: item.docs.clone(),
                span: item.span,
            })
        });
        let markers = parameters(&self.program, definition).into_iter();
        let markers = markers.filter(|parameter| {
            let ty = self.findings.types.get(&parameter.ty.span);
            matches!(ty, Some(Type::Marker))
        });
        Some(ClassText {
            levels: texts.collect(),
            markers: markers
                .map(|parameter| parameter.name.text.clone())
                .collect(),
        })
    }
}
