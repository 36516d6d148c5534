//! The cards of a deck that have no place in a mesh, and the content that is lost with them.

use super::lines::At;
pub(super) use crate::read::unread::UnreadCards;
use crate::read::unread::carries;

impl UnreadCards {
    /// Counts a card that Eng does not read.
    pub(super) fn card(&mut self, name: &str, at: &At) {
        self.note(name, at, carries(name, STRUCTURE, NOTHING));
    }
}

/// Cards of mass, stiffness or constraint. The list has properties and materials only if Eng reads their
/// elements without them.
const STRUCTURE: &[&str] = &[
    "BCONP", "BCTADD", "BCTSET", "CACINF3", "CACINF4", "CBEAM3", "CBEND", "CBUSH2D", "CFAST",
    "CGAP", "CHACAB", "CHACBR", "CNGRET", "CONV", "CPLSTN3", "CPLSTN4", "CPLSTN6", "CPLSTN8",
    "CPLSTS3", "CPLSTS4", "CPLSTS6", "CPLSTS8", "CQUAD", "CQUADX", "CRAC2D", "CRAC3D", "CSEAM",
    "CSUPEXT", "CTRAX3", "CTRAX6", "CTRIAX", "CTRIAX6", "CQUADX4", "CQUADX8", "CWELD", "DMIG",
    "DMIAX", "EBDADD", "EBDSET", "GENEL", "GMBC", "GMSPC", "PGAP", "RJOINT", "RSSCON", "SEBNDRY",
    "SEBULK", "SECONCT", "SEELT", "SEEXCLD", "SELABEL", "SELOC", "SEMPLN", "SESET", "SETREE",
    "SNORM", "SPCOFF", "SPCOFF1", "CYJOIN", "CYSYM", "TF",
];

/// Cards of loads, requests and solution methods, for [`carries`].
const NOTHING: &[&str] = &[
    "ACCEL", "ACCEL1", "AECOMP", "AECOMPL", "AEFACT", "AELINK", "AELIST", "AEPARM", "AERO",
    "AEROS", "AESTAT", "AESURF", "AESURFS", "AEFORCE", "AEPRESS", "ASSIGN", "BLSEG", "CAERO.",
    "CDAMP.", "CLOAD", "CSSCHD", "CVISC", "PDAMP.", "PVISC", "CBARAO", "DAREA", "DCONADD",
    "DCONSTR", "DEBUG", "DEFORM", "DELAY", "DESVAR", "DEQATN", "DIVERG", "DLINK", "DLOAD", "DMI",
    "DOPTPRM", "DPHASE", "DRESP.", "DSCREEN", "DTABLE", "DTI", "DVCREL.", "DVGRID", "DVMREL.",
    "DVPREL.", "DVTREL1", "DMNCON", "DMRLAW", "GROUP", "ECHOOFF", "ECHOON", "EIGB", "EIGC", "EIGR",
    "EIGRL", "FLFACT", "FLUTTER", "FORCE", "FORCE1", "FORCE2", "FREQ", "FREQ.", "GRAV", "GUST",
    "LOAD", "LSEQ", "MAT4", "MAT5", "MDLPRM", "MKAERO.", "MOMENT", "MOMENT1", "MOMENT2", "MONPNT.",
    "MONDSP1", "NLPARM", "NLPCI", "OMIT", "OMIT1", "PAERO.", "PAERO", "PLOAD", "PLOAD.", "PLOTEL",
    "PLOTEL.", "POINT", "QBDY.", "QVOL", "RANDPS", "RANDT1", "RFORCE", "RFORCE1", "RLOAD.", "SET2",
    "SLOAD", "SPCD", "SPLINE.", "STAT", "SUPAX", "SUPORT", "SUPORT1", "TABDMP1", "TABLE3D",
    "TABLED.", "TABLEM.", "TABLES1", "TABLEST", "TABRND1", "TEMP", "TEMPD", "TEMPP.", "TEMPRB",
    "TEMPBC", "TIC", "TLOAD.", "TRIM", "TSTEP", "TSTEP1", "TSTEPNL", "USET", "USET1", "MATS1",
    "MAT2", "MAT3", "MAT8", "MAT9", "MAT10", "MAT11", "VIEW", "VIEW3D", "RADM", "RADSET", "PSET",
    "PVAL", "BNDFIX", "BNDFIX1", "BNDFREE", "BNDFREE1", "OUTPUT", "PARAM", "DCONSTR", "TOPVAR",
    "NLSTEP", "NLCNTL.", "TABRNDG", "BCBDPRP", "BCONPRP", "BCTPARA", "BCRPARA", "DDVAL", "DSC",
];
