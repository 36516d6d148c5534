//! The registry of message codes of resolving (`02`) and checking (`03` types and units, `04` classes and their uses).
//!
//! A code never changes its meaning; a test asserts that each is raised by a fixture.

/// A code and what it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// `E0302`.
    pub code: &'static str,
    /// What is wrong, in general.
    pub title: &'static str,
}

macro_rules! codes {
    ($($name:ident = $code:literal, $title:literal;)*) => {
        $(#[doc = $title] pub const $name: &str = $code;)*

        /// All codes, in order.
        pub const CODES: &[Code] = &[$(Code { code: $code, title: $title }),*];
    };
}

codes! {
    NO_MODULE = "E0201", "a module or file that is used does not exist";
    USE_CIRCLE = "E0202", "modules use each other in a circle";
    NOT_IN_MODULE = "E0203", "a module has no item of this name";
    DEFINED_TWICE = "E0204", "a name is defined twice";
    UNKNOWN_NAME = "E0205", "a name is not known";
    UNKNOWN_UNIT = "E0206", "a unit is not known";
    UNKNOWN_TYPE = "E0207", "a type or dimension is not known";
    UNIT_CIRCLE = "E0208", "dimensions or units are defined by each other";
    BAD_UNIT = "E0209", "the definition of a dimension or unit does not make sense";
    AMBIGUOUS_USE = "E0210", "two modules bring the same name";
    NO_MEMBER = "E0211", "a thing has no member of this name";
    UNUSED_USE = "W0201", "a name is taken from a module but not used";

    UNIT_MISSING = "E0301", "a number without a unit stands where a quantity is due";
    DIMENSION = "E0302", "a quantity has another dimension than is due";
    OPERANDS = "E0303", "two quantities of different dimensions are added or compared";
    ANGLE = "E0304", "two quantities differ by an angle";
    VALUE_CIRCLE = "E0305", "values are defined by each other";
    POINT = "E0306", "a point stands for a difference, or the other way round";
    POINT_ARITHMETIC = "E0307", "points are added or multiplied";
    AFFINE_UNIT = "E0308", "a unit with a shifted zero is used where only its size can count";
    WRONG_TYPE = "E0309", "a thing of another type is due";
    COMPONENT_WITHOUT_AXES = "E0311", "a component of a vector is taken in no stated axes";
    OUTPUT_WITHOUT_FRAME = "E0312", "an output of a vector does not state its axes";
    FRAME = "E0313", "axes are stated wrongly";
    LIST_ELEMENTS = "E0314", "the elements of a list differ in type or dimension";
    LIST_LENGTH = "E0315", "a list has another length than is due";
    CONDITION = "E0316", "a condition is neither true nor false";
    INDEX = "E0317", "an index is missing, too much or not a whole number";
    OPERATOR = "E0318", "an operator does not apply to these things";
    POWER = "E0319", "an exponent does not give a dimension";
    DERIVATIVE = "E0320", "a velocity is differentiated, or constrained, where only positions can be";
    ACCELERATION = "E0321", "accelerations and reactions are used outside outputs";
    DISPLAY = "E0322", "a unit after `as` has another dimension than the value";
    UNIT_TWICE = "E0323", "a unit stands on something that is not a plain number";
    RANGE = "E0324", "a range is not one of counts, or has no step";
    STRUCTURAL = "E0325", "a parameter decides a count";
    TOO_DEEP = "E0326", "values build on each other too deeply";
    FLEXIBLE = "E0390", "flexible bodies are not built yet";
    NOT_BUILT = "E0391", "a part of the language is not built yet";
    UNUSED_LET = "W0301", "a value is not used";

    NOT_CALLABLE = "E0401", "a thing that is no function or class is called";
    MISSING_ARGUMENT = "E0402", "an argument is missing";
    UNKNOWN_ARGUMENT = "E0403", "an argument has a name that no parameter has";
    ARGUMENT_TWICE = "E0404", "an argument is given twice";
    TOO_MANY_ARGUMENTS = "E0405", "there are more arguments than parameters";
    MISPLACED = "E0406", "an item does not belong here";
    INTERFACE = "E0407", "a class does not give what its interface promises";
    NOT_OF_INTERFACE = "E0408", "a class does not belong to the interface that is due";
    UNKNOWN_ATTRIBUTE = "E0409", "an attribute is not known";
    KIND = "E0410", "a class is used as another kind";
    CONSTRAINT_FORM = "E0411", "a constraint is not an equation of scalars or vectors";
    MISSING_ATTRIBUTE = "E0412", "an attribute is missing";
    NO_CYCLE = "E0413", "the model has no cycle";
    STATE = "E0414", "a state and its rate do not match";
    MISSING_VALUE = "E0415", "a definition has no value or no type";
    TABLE = "E0416", "the definition of a table does not make sense";
    ANALYSIS = "E0417", "an analysis cannot be made like this";
    MARKER = "E0418", "the place of a marker cannot be read";
    START = "E0419", "this cannot be set at the start";
}
