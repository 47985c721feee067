#pragma once
// Label volumes into files:  label volume -> [IO] -> .seg.nrrd, .nii, .nii.gz
#include <filesystem>

#include "core/io/labels/label_table.h"
#include "core/io/volumes/label_volume.h"
#include "core/slice/result.h"

namespace sonoloft {

// Every writer: 16 bits a voxel, mm, LPS; a program that opens volume and mesh shows one upon the other. The file is
// replaced.
// @pre   the volume's sizes fit its number of labels, at most kMaxVolumeSide a side
// @error io_failed: the file is incomplete
// @cost  O(#voxels), one buffer of 1 MiB; packing takes most of the time

/// A segmentation of 3D Slicer: NRRD, packed, a segment for every label but outside with its name, its value, its
/// colour and the voxels that it reaches over. Source: teem's definition of NRRD; Slicer's "Segmentations" file format.
[[nodiscard]] Result<void> write_seg_nrrd(const LabelVolume& volume, const std::filesystem::path& path,
                                          const LabelTable& labels = {});

/// NIfTI-1 in one file, packed where the name ends in .gz: intent "label", without names and
/// colours. The format has its x to the right and its y to the front, LPS has neither: voxels keep their order, the
/// transform (qform and sform, the same) turns x and y round. Source: nifti1.h of the NIfTI Data Format Working Group.
[[nodiscard]] Result<void> write_nifti(const LabelVolume& volume, const std::filesystem::path& path);

}  // namespace sonoloft
