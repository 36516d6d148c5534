//! Words of choices in place of those of the text: `--set end=driving_end`.

use super::Analysis;
use crate::error::Error;
use crate::program::{Bodies, Program};
use eng_compiler::elaborate::Structural;
use eng_compiler::program::{DefinitionId, ValueType};

impl Program {
    /// The choice of a constant of a model; `None` if the path names something else.
    fn choice_at(&self, model: DefinitionId, path: &str) -> Option<DefinitionId> {
        match self.typed().of(model, path) {
            Some(ValueType::Choice(choice)) => Some(*choice),
            _ => None,
        }
    }
}

impl Analysis {
    /// Whether a path names a constant of its model that is a word of a choice.
    pub fn chooses(&self, path: &str) -> bool {
        let plan = self.program.plan(self.name());
        plan.is_ok_and(|plan| self.program.choice_at(plan.model, path).is_some())
    }

    /// Takes a word of a choice in place of the text's. The model is compiled again, because a word is part of its
    /// structure. Parameters that were set before keep their values.
    pub fn choose(mut self, path: &str, word: &str) -> Result<Self, Error> {
        let program = self.program.clone();
        let plan = program.plan(self.name())?;
        let resolved = &program.typed().program;
        let Some(choice) = program.choice_at(plan.model, path) else {
            return Err(self.parameter(path).err().unwrap_or(Error::OtherModel));
        };
        let words: Vec<&str> = (0..).map_while(|at| resolved.word(choice, at)).collect();
        let Some(at) = words.iter().position(|known| *known == word) else {
            return Err(Error::NoWord {
                path: path.to_owned(),
                word: word.to_owned(),
                words: words.join(", "),
            });
        };
        if program.varies(self.name(), path) {
            return Err(Error::Swept {
                path: path.to_owned(),
                analysis: self.name().to_owned(),
            });
        }
        self.chosen.retain(|(known, ..)| known != path);
        self.chosen.push((
            path.to_owned(),
            word.to_owned(),
            Structural::Choice(choice, at as u32),
        ));
        let mut constants = plan.constants.clone();
        for (path, _, value) in &self.chosen {
            constants.retain(|(known, _)| known != path);
            constants.push((path.clone(), value.clone()));
        }
        let model = program.compile(plan.model, &constants, Bodies::Reduced)?;
        let mut made = Analysis::new(model, self.plan.clone(), program.clone())?;
        for path in &self.set_here {
            let old = self.model.parameter(path)?;
            let new = made.model.parameter(path)?;
            let value = self.overrides.get(old.index).copied().flatten();
            if let Some(place) = made.overrides.get_mut(new.index) {
                *place = value;
            }
        }
        let before = format!("{path} = ");
        made.replaced = self.replaced;
        made.replaced.retain(|line| !line.starts_with(&before));
        made.replaced
            .push(format!("{path} = {word} in place of the word of the text"));
        made.set_here = self.set_here;
        made.stepped_here = self.stepped_here;
        made.chosen = self.chosen;
        made.recording = self.recording;
        Ok(made)
    }
}
