//! Elements of a workspace that are not part of a chart.

/// Elements that hold data and have no effect until something names them.
pub(super) fn is_data(tag: &str) -> bool {
    matches!(
        tag,
        "BooleanList"
            | "IntegerList"
            | "RealList"
            | "StringList"
            | "IndexVariable"
            | "IntegerAttributeVariable"
            | "RealAttributeVariable"
            | "StringAttributeVariable"
            | "ByteStreamIn"
            | "ByteStreamOut"
            | "DPWSObject"
            | "LabCommObject"
            | "GCClass"
    ) || tag.starts_with("XML")
}

/// Elements that are only drawn.
pub(super) fn is_drawing(tag: &str) -> bool {
    matches!(
        tag,
        "GCRectangle"
            | "GC3DRect"
            | "GCEllipse"
            | "GCPolygon"
            | "GCStroke"
            | "GCLine"
            | "GCSpline"
            | "GCImage"
            | "Icon"
            | "LUCASLogo"
            | "Browser"
            | "SFCPlotter"
            | "ShowWorkspaceButton"
    )
}
