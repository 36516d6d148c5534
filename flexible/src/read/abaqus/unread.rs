//! Keywords that are not read, and what is lost with them.

use crate::mesh::Carries;

/// Keywords whose data lines are needed (names without blanks).
pub(super) const KEPT: &[&str] = &[
    "BEAMGENERALSECTION",
    "BEAMSECTION",
    "BOUNDARY",
    "COUPLING",
    "DENSITY",
    "DISTRIBUTING",
    "ELASTIC",
    "EQUATION",
    "INSTANCE",
    "KINEMATIC",
    "KINEMATICCOUPLING",
    "MASS",
    "MATERIAL",
    "MPC",
    "RIGIDBODY",
    "ROTARYINERTIA",
    "SHELLSECTION",
    "SOLIDSECTION",
    "SPRING",
    "SURFACE",
    "SYSTEM",
    "TRANSFORM",
];

/// Keywords of mass, stiffness or constraints, and of nodes and elements made by rule.
const STRUCTURE: &[&str] = &[
    "ADJUST",
    "BULKVISCOSITY",
    "COHESIVESECTION",
    "CONNECTORSECTION",
    "CONTACTPAIR",
    "CYCLICSYMMETRYMODEL",
    "DASHPOT",
    "DISTRIBUTINGCOUPLING",
    "ELCOPY",
    "ELGEN",
    "EMBEDDEDELEMENT",
    "FASTENER",
    "FRAMESECTION",
    "GAP",
    "GASKETSECTION",
    "JOINT",
    "MATRIXASSEMBLE",
    "MATRIXINPUT",
    "MEMBRANESECTION",
    "NCOPY",
    "NFILL",
    "NGEN",
    "NMAP",
    "NODALTHICKNESS",
    "NONSTRUCTURALMASS",
    "NORMAL",
    "PRETENSIONSECTION",
    "REBAR",
    "REBARLAYER",
    "RELEASE",
    "SHELLGENERALSECTION",
    "SHELLTOSOLIDCOUPLING",
    "SUBMODEL",
    "SUBSTRUCTUREPROPERTY",
    "SURFACESECTION",
    "TIE",
    "TRANSVERSESHEARSTIFFNESS",
    "UEL",
    "UELPROPERTY",
    "USERELEMENT",
];

/// Keywords of loads, requests, contact laws and drawing.
const NOTHING: &[&str] = &[
    "AMPLITUDE",
    "CLEARANCE",
    "CONTACT",
    "CONTACTINCLUSIONS",
    "CONTACTPROPERTYASSIGNMENT",
    "DISTRIBUTION",
    "DISTRIBUTIONTABLE",
    "ELFILE",
    "ELOUTPUT",
    "ELPRINT",
    "FRICTION",
    "HOURGLASSSTIFFNESS",
    "INITIALCONDITIONS",
    "NODEFILE",
    "NODEOUTPUT",
    "NODEPRINT",
    "OUTPUT",
    "ORIENTATION",
    "PARAMETER",
    "PHYSICALCONSTANTS",
    "PREPRINT",
    "RESTART",
    "SECTIONCONTROLS",
    "SURFACEBEHAVIOR",
    "SURFACEINTERACTION",
    "TIMEPOINTS",
    "USERMATERIAL",
    "VALUESATINFINITY",
];

/// What a keyword (without blanks) carries.
pub(super) fn carries(key: &str) -> Carries {
    if STRUCTURE.contains(&key) {
        Carries::Structure
    } else if NOTHING.contains(&key) {
        Carries::Nothing
    } else {
        Carries::Unknown
    }
}
