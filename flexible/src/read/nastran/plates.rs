//! Shells: the fields after their grid points, `PSHELL`, `PCOMP`, `PCOMPG`, and the materials `MAT2` and
//! `MAT8` of sheets.

use super::card::Card;
use super::frames::Systems;
use super::lines::At;
use super::number;
use super::unread::UnreadCards;
use crate::error::FileProblem;
use crate::mesh::{Carries, Layup, SheetElasticity, ShellAxis, ShellSection, ShellShape};

/// `THETA` or `MCID`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axis {
    /// Angle (°) from the side G1–G2, with mid-side nodes from the line of constant η.
    Angle(f64),
    /// The x axis of this coordinate system.
    System(u64),
}

/// Fields of a shell after its grid points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShellFields {
    axis: Axis,
    offset: f64,
    /// Number of corners.
    corners: usize,
    thickness: [Option<f64>; 4],
    /// Whether the thicknesses are shares of that of the property.
    relative: bool,
}

/// Thickness of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Thickness {
    /// That of the property.
    OfProperty,
    /// The same everywhere.
    Own(f64),
    /// At the corners, with their mean.
    Varying(f64, [f64; 4]),
}

impl ShellFields {
    /// Reads them. Their places depend on the card.
    pub fn read(card: &Card, corners: usize) -> Result<Self, FileProblem> {
        // angle, offset, flag, first thickness
        let [angle, offset, flag, first] = match card.name.as_str() {
            "CTRIA6" => [8, 9, 13, 10],
            "CQUAD8" => [14, 15, 16, 10],
            "CQUAD4" | "CQUADR" => [6, 7, 9, 10],
            _ => [5, 6, 9, 10],
        };
        let system = number::integer(card.text(angle)).and_then(|id| u64::try_from(id).ok());
        let axis = match system {
            Some(id) => Axis::System(id),
            None => Axis::Angle(card.real_or_zero(angle, "THETA")?),
        };
        let mut thickness = [None; 4];
        for (i, own) in thickness.iter_mut().enumerate().take(corners) {
            *own = card.optional_real(first + i, &format!("T{}", i + 1))?;
        }
        Ok(ShellFields {
            axis,
            offset: card.real_or_zero(offset, "ZOFFS")?,
            corners,
            thickness,
            relative: card.text(flag) == "1",
        })
    }

    /// The thickness. Corners without one have that of the property.
    ///
    /// # Errors
    /// Neither a corner nor the property has a thickness.
    pub fn thickness(
        &self,
        property: Option<f64>,
        element: u64,
        at: &At,
    ) -> Result<Thickness, FileProblem> {
        if self.thickness == [None; 4] {
            return Ok(Thickness::OfProperty);
        }
        let mut own = [0.0; 4];
        for (own, stated) in own.iter_mut().zip(&self.thickness).take(self.corners) {
            let found = match (stated, self.relative) {
                (Some(share), true) => property.map(|t| share * t),
                (Some(stated), false) => Some(*stated),
                (None, _) => property,
            };
            *own = found.ok_or_else(|| {
                at.problem(
                    format!("element {element} has no thickness at one of its grid points"),
                    "give T in its property; or give T1 to T4 at all its grid points and leave TFLAG blank",
                )
            })?;
        }
        let own_corners = &own[..self.corners];
        let [first, others @ ..] = own_corners else {
            return Ok(Thickness::OfProperty);
        };
        if others.iter().all(|other| other == first) {
            return Ok(Thickness::Own(*first));
        }
        let mean = own_corners.iter().sum::<f64>() / self.corners as f64;
        Ok(Thickness::Varying(mean, own))
    }

    /// Position, thickness and axes of the shell; `None` if they are those of its property. An isotropic one is not
    /// `directed`: it needs no axes. The middle surface of its property is `beside` the reference plane.
    pub fn shape(
        &self,
        (thickness, directed, beside): (Thickness, bool, f64),
        systems: &Systems,
        (element, at): (u64, &At),
        unread: &mut UnreadCards,
    ) -> Result<Option<ShellShape>, FileProblem> {
        let axis = match self.axis {
            _ if !directed => ShellAxis::Side(0.0),
            Axis::Angle(degrees) => ShellAxis::Side(degrees.to_radians()),
            Axis::System(id) => {
                let user = || format!("element {element}");
                let rotation = systems.axes_at(id, [0.0; 3], &user, at)?;
                if !systems.is_rectangular(id) {
                    let name = "MCID of a cylindrical or spherical system";
                    unread.note(name, at, Carries::Structure);
                }
                ShellAxis::Direction(rotation.map(|[x, _, _]| x), 0.0)
            }
        };
        let shape = ShellShape {
            offsets: [self.offset + beside; 4],
            thickness: match thickness {
                Thickness::Varying(_, own) => Some(own),
                _ => None,
            },
            axis,
        };
        Ok((shape != ShellShape::default()).then_some(shape))
    }
}

/// `PSHELL`, with the numbers of its materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlateCard {
    /// Without one the elements state it.
    pub thickness: Option<f64>,
    /// All but thickness and materials.
    pub section: ShellSection,
    /// Materials of bending and shear, if they differ from that of the membrane.
    pub apart: Option<[Option<u64>; 2]>,
}

impl PlateCard {
    /// `PSHELL PID MID1 T MID2 12I/T³ MID3 TS/T NSM / Z1 Z2 MID4`, and its first material. Without any material
    /// it is a facet, without MID2 a membrane; without MID3 it has no shear flexibility.
    pub fn read(card: &Card, unread: &mut UnreadCards) -> Result<(Option<u64>, Self), FileProblem> {
        let membrane = card.optional_id(1, "MID1")?.filter(|id| *id > 0);
        let plane_strain = card.text(3) == "-1";
        let bending = match plane_strain {
            true => None,
            false => card.optional_id(3, "MID2")?.filter(|id| *id > 0),
        };
        let shear = card.optional_id(5, "MID3")?.filter(|id| *id > 0);
        let lost = match (membrane.is_some(), bending.is_some()) {
            _ if plane_strain => Some("PSHELL of plane strain"),
            (false, true) => Some("PSHELL without MID1"),
            (true, _) if !card.is_blank(10) => Some("PSHELL with MID4"),
            _ => None,
        };
        if let Some(name) = lost {
            unread.note(name, &card.at, Carries::Structure);
        }
        let material = membrane.or(bending);
        let plain = bending == material && shear.is_none_or(|shear| Some(shear) == material);
        let section = ShellSection {
            mass_per_area: card.real_or_zero(7, "NSM")?,
            bending: card.optional_real(4, "12I/T**3")?.unwrap_or(1.0),
            shear: match shear {
                Some(_) => card.optional_real(6, "TS/T")?.unwrap_or(5.0 / 6.0),
                None => 0.0,
            },
            ..ShellSection::plate(0.0)
        };
        let plate = PlateCard {
            thickness: card.optional_real(2, "T")?,
            section,
            apart: (!plain && material.is_some()).then_some([bending, shear]),
        };
        Ok((material, plate))
    }

    /// The section, with the indices of its materials.
    pub fn section(
        &self,
        thickness: f64,
        mass_scale: f64,
        [bending, shear]: [Option<u32>; 2],
    ) -> ShellSection {
        ShellSection {
            thickness,
            mass_per_area: self.section.mass_per_area * mass_scale,
            layup: match self.apart {
                None => Layup::One,
                Some(_) => Layup::Apart { bending, shear },
            },
            ..self.section
        }
    }
}

/// `PCOMP` or `PCOMPG`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LaminateCard {
    /// Material, thickness and angle (°) of each layer, from the lower surface to the upper.
    pub layers: Vec<(u64, f64, f64)>,
    /// From the reference plane to the middle surface.
    pub offset: f64,
    pub mass_per_area: f64,
}

impl LaminateCard {
    /// `PCOMP PID Z0 NSM SB FT TREF GE LAM / MID1 T1 THETA1 SOUT1 …`: a blank material or thickness is that of the
    /// layer before. `PCOMPG` has one layer on a line: `GPLYID MID T THETA SOUT`.
    pub fn read(card: &Card, unread: &mut UnreadCards) -> Result<Self, FileProblem> {
        let (width, first) = match card.name.as_str() {
            "PCOMPG" => (8, 1),
            _ => (4, 0),
        };
        let mut layers: Vec<(u64, f64, f64)> = Vec::new();
        for line in (8..card.len()).step_by(width) {
            if (line..line + width).all(|i| card.is_blank(i)) {
                continue;
            }
            let number = layers.len() + 1;
            let last = layers.last().map(|(id, thickness, _)| (*id, *thickness));
            let [material, thickness] = [first, first + 1].map(|i| line + i);
            let id = match (card.is_blank(material), last) {
                (true, Some((id, _))) => id,
                _ => card.id(material, &format!("MID{number}"))?,
            };
            let own = match (card.is_blank(thickness), last) {
                (true, Some((_, thickness))) => thickness,
                _ => card.real(thickness, &format!("T{number}"))?,
            };
            let angle = card.real_or_zero(line + first + 2, &format!("THETA{number}"))?;
            layers.push((id, own, angle));
        }
        if layers.is_empty() {
            return Err(card.problem(
                "the laminate has no layer",
                "give the material and the thickness of each layer",
            ));
        }
        match card.text(7) {
            "" => {}
            "SYM" => {
                let mirrored: Vec<_> = layers.iter().rev().copied().collect();
                layers.extend(mirrored);
            }
            other => {
                let name = format!("{}, LAM = {other}", card.name);
                unread.note(&name, &card.at, Carries::Structure);
            }
        }
        let total: f64 = layers.iter().map(|(_, thickness, _)| thickness).sum();
        let bottom = card.optional_real(1, "Z0")?;
        Ok(LaminateCard {
            layers,
            offset: bottom.map_or(0.0, |bottom| bottom + 0.5 * total),
            mass_per_area: card.real_or_zero(2, "NSM")?,
        })
    }

    /// Thickness of all layers.
    pub fn thickness(&self) -> f64 {
        self.layers.iter().map(|(_, thickness, _)| thickness).sum()
    }
}

/// Elasticity and density of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SheetConstants {
    /// `E1` or `G11`.
    pub young: f64,
    /// `NU12`; zero of `MAT2`.
    pub poisson: f64,
    pub density: f64,
    /// As the material of membrane and bending.
    pub plane: SheetElasticity,
    /// As `MID3`: the shear across the plate.
    pub across: SheetElasticity,
}

impl SheetConstants {
    /// `MAT2 MID G11 G12 G13 G22 G23 G33 RHO`. As `MID3` G11, G12 and G22 are those of the shear across the plate.
    pub fn anisotropic(card: &Card) -> Result<Self, FileProblem> {
        let mut g = [0.0; 6];
        for ((i, g), name) in g
            .iter_mut()
            .enumerate()
            .zip(["G11", "G12", "G13", "G22", "G23", "G33"])
        {
            *g = card.real_or_zero(1 + i, name)?;
        }
        let [g11, g12, g13, g22, g23, g33] = g;
        let plane = [[g11, g12, g13], [g12, g22, g23], [g13, g23, g33]];
        Ok(SheetConstants {
            young: g11,
            poisson: 0.0,
            density: card.real_or_zero(7, "RHO")?,
            plane: SheetElasticity {
                plane,
                across: None,
            },
            across: SheetElasticity {
                // only the shear counts
                plane: [[g11, 0.0, 0.0], [0.0, g11, 0.0], [0.0, 0.0, g11]],
                across: Some([[g11, g12], [g12, g22]]),
            },
        })
    }

    /// `MAT8 MID E1 E2 NU12 G12 G1Z G2Z RHO`. Without G1Z and G2Z there is no shear flexibility.
    pub fn orthotropic(card: &Card) -> Result<Self, FileProblem> {
        let constants = [
            card.real(1, "E1")?,
            card.real(2, "E2")?,
            card.real(3, "NU12")?,
            card.real_or_zero(4, "G12")?,
        ];
        let across = [card.real_or_zero(5, "G1Z")?, card.real_or_zero(6, "G2Z")?];
        let Some(sheet) = SheetElasticity::orthotropic(constants, across) else {
            return Err(card.problem(
                "no elastic sheet has these constants",
                "E1, E2 and G12 must be above zero, and NU12 squared below E1/E2; without shear flexibility, leave G1Z and G2Z blank",
            ));
        };
        Ok(SheetConstants {
            young: constants[0],
            poisson: constants[2],
            density: card.real_or_zero(7, "RHO")?,
            plane: sheet,
            across: sheet,
        })
    }
}
