"""What a person sees and the files that are written. The only importer of plotting packages; they load when first drawn with."""
