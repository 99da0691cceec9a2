//! The forms of cells.

/// The form of a cell, with corners alone (linear) or with nodes between them too (quadratic).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Two nodes.
    Line,
    /// Three nodes: one end, the middle, the other end.
    QuadraticLine,
    /// Three corners.
    Triangle,
    /// Three corners, three nodes between them.
    QuadraticTriangle,
    /// Four corners.
    Quadrilateral,
    /// Four corners, four nodes between them.
    QuadraticQuadrilateral,
    /// Four corners.
    Tetrahedron,
    /// Four corners, six nodes between them.
    QuadraticTetrahedron,
    /// Six corners.
    Wedge,
    /// Six corners, nine nodes between them.
    QuadraticWedge,
    /// Eight corners.
    Hexahedron,
    /// Eight corners, twelve nodes between them.
    QuadraticHexahedron,
}

/// Beginnings of types of elements, and the form for each number of nodes or name that follows.
type Family = (&'static [&'static str], &'static [(&'static str, Shape)]);

impl Shape {
    /// The number of nodes of a cell.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::Line => 2,
            Self::QuadraticLine | Self::Triangle => 3,
            Self::Quadrilateral | Self::Tetrahedron => 4,
            Self::QuadraticTriangle | Self::Wedge => 6,
            Self::QuadraticQuadrilateral | Self::Hexahedron => 8,
            Self::QuadraticTetrahedron => 10,
            Self::QuadraticWedge => 15,
            Self::QuadraticHexahedron => 20,
        }
    }

    /// `true` if the cell fills space, so that a neighbour can hide its faces.
    #[must_use]
    pub const fn is_solid(self) -> bool {
        matches!(
            self,
            Self::Tetrahedron
                | Self::QuadraticTetrahedron
                | Self::Wedge
                | Self::QuadraticWedge
                | Self::Hexahedron
                | Self::QuadraticHexahedron
        )
    }

    /// The faces, each as positions of its corners in the cell: against the clock as seen from outside, of flat cells as seen
    /// from the side where the nodes run against the clock. Lines have none.
    #[must_use]
    pub const fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Line | Self::QuadraticLine => &[],
            Self::Triangle | Self::QuadraticTriangle => &[&[0, 1, 2]],
            Self::Quadrilateral | Self::QuadraticQuadrilateral => &[&[0, 1, 2, 3]],
            Self::Tetrahedron | Self::QuadraticTetrahedron => {
                &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]]
            }
            Self::Wedge | Self::QuadraticWedge => {
                &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[0, 3, 5, 2]]
            }
            Self::Hexahedron | Self::QuadraticHexahedron => &[
                &[0, 3, 2, 1],
                &[4, 5, 6, 7],
                &[0, 1, 5, 4],
                &[1, 2, 6, 5],
                &[2, 3, 7, 6],
                &[3, 0, 4, 7],
            ],
        }
    }

    /// The number by which VTK knows the form.
    ///
    /// Source: VTK, vtkCellType.h.
    #[must_use]
    pub const fn vtk(self) -> u8 {
        match self {
            Self::Line => 3,
            Self::Triangle => 5,
            Self::Quadrilateral => 9,
            Self::Tetrahedron => 10,
            Self::Hexahedron => 12,
            Self::Wedge => 13,
            Self::QuadraticLine => 21,
            Self::QuadraticTriangle => 22,
            Self::QuadraticQuadrilateral => 23,
            Self::QuadraticTetrahedron => 24,
            Self::QuadraticHexahedron => 25,
            Self::QuadraticWedge => 26,
        }
    }

    /// The form of an element of Abaqus or CalculiX; `Ok(None)` for those without one, such as springs and masses.
    ///
    /// # Errors
    /// Returns an error if the type is not known.
    pub(super) fn of_element(kind: &str) -> Result<Option<Self>, ()> {
        const POINTS: [&str; 10] = [
            "SPRING", "DASHPOT", "MASS", "ROTARY", "GAP", "CONN", "DCOUP", "HEATCAP", "JOINT",
            "ITT",
        ];
        let kind = kind.to_uppercase();
        if POINTS.iter().any(|start| kind.starts_with(start)) {
            return Ok(None);
        }
        // The letters after the number of nodes choose integration and formulation.
        let families: [Family; 4] = [
            (
                &["C3D", "AC3D", "DC3D", "SC"],
                &[
                    ("20", Self::QuadraticHexahedron),
                    ("15", Self::QuadraticWedge),
                    ("10", Self::QuadraticTetrahedron),
                    ("8", Self::Hexahedron),
                    ("6", Self::Wedge),
                    ("4", Self::Tetrahedron),
                ],
            ),
            (
                &["STRI", "S", "M3D", "CPS", "CPE", "CAX", "CPEG", "R3D", "SFM3D"],
                &[
                    ("65", Self::QuadraticTriangle),
                    ("8", Self::QuadraticQuadrilateral),
                    ("6", Self::QuadraticTriangle),
                    ("4", Self::Quadrilateral),
                    ("3", Self::Triangle),
                ],
            ),
            (
                &["B"],
                &[
                    ("31", Self::Line),
                    ("21", Self::Line),
                    ("32", Self::QuadraticLine),
                    ("22", Self::QuadraticLine),
                    ("33", Self::Line),
                    ("23", Self::Line),
                ],
            ),
            (&["T3D", "T2D", "F3D", "D"], &[("2", Self::Line), ("3", Self::QuadraticLine)]),
        ];
        let known = families.iter().find_map(|(starts, forms)| {
            starts.iter().find_map(|start| {
                let rest = kind.strip_prefix(start)?;
                let fits = |digits: &str| {
                    let after = rest.strip_prefix(digits)?;
                    (!after.starts_with(|c: char| c.is_ascii_digit())).then_some(())
                };
                forms.iter().find_map(|&(digits, form)| fits(digits).map(|()| form))
            })
        });
        known.map(Some).ok_or(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_types_of_abaqus_and_calculix_are_known() {
        for (kind, form) in [
            ("C3D4", Shape::Tetrahedron),
            ("c3d6", Shape::Wedge),
            ("C3D8", Shape::Hexahedron),
            ("C3D8I", Shape::Hexahedron),
            ("C3D8R", Shape::Hexahedron),
            ("C3D8RH", Shape::Hexahedron),
            ("C3D10", Shape::QuadraticTetrahedron),
            ("C3D10M", Shape::QuadraticTetrahedron),
            ("C3D15", Shape::QuadraticWedge),
            ("C3D20R", Shape::QuadraticHexahedron),
            ("SC8R", Shape::Hexahedron),
            ("S3", Shape::Triangle),
            ("S3R", Shape::Triangle),
            ("STRI65", Shape::QuadraticTriangle),
            ("STRI3", Shape::Triangle),
            ("S4", Shape::Quadrilateral),
            ("S4R5", Shape::Quadrilateral),
            ("S6", Shape::QuadraticTriangle),
            ("S8R", Shape::QuadraticQuadrilateral),
            ("CPS4R", Shape::Quadrilateral),
            ("B31", Shape::Line),
            ("B32R", Shape::QuadraticLine),
            ("T3D2", Shape::Line),
        ] {
            assert_eq!(Shape::of_element(kind), Ok(Some(form)), "{kind}");
        }
        assert_eq!(Shape::of_element("SPRINGA"), Ok(None));
        assert_eq!(Shape::of_element("DCOUP3D"), Ok(None));
        for unknown in ["", "C3D", "C3D27", "C3D200", "S9", "U1", "ELBOW31"] {
            assert_eq!(Shape::of_element(unknown), Err(()), "{unknown}");
        }
    }
}
