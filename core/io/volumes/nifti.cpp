#include <algorithm>
#include <string>

#include "core/io/volumes/volume_files.h"
#include "core/io/volumes/voxel_file.h"

namespace sonoloft {
namespace {

/// nifti1.h
struct NiftiHeader {
  std::int32_t sizeof_hdr = 348;
  char unused[36]{};
  std::int16_t dim[8]{3, 1, 1, 1, 1, 1, 1, 1};
  float intent_p[3]{};
  std::int16_t intent_code = 1002;  ///< NIFTI_INTENT_LABEL
  std::int16_t datatype = 512;      ///< NIFTI_TYPE_UINT16
  std::int16_t bitpix = 16;
  std::int16_t slice_start = 0;
  float pixdim[8]{1};      ///< first of all: the sign of the third axis in the qform
  float vox_offset = 352;  ///< the header, and 4 bytes that say that nothing extends it
  float scl_slope = 1, scl_inter = 0;
  std::int16_t slice_end = 0;
  char slice_code = 0;
  char xyzt_units = 2;  ///< NIFTI_UNITS_MM
  float cal_max = 0, cal_min = 0, slice_duration = 0, toffset = 0;
  std::int32_t glmax = 0, glmin = 0;
  char descrip[80] = "SonoLoft";
  char aux_file[24]{};
  std::int16_t qform_code = 1, sform_code = 1;  ///< NIFTI_XFORM_SCANNER_ANAT
  float quaternion[3]{0, 0, 1};                 ///< half a turn around z
  float offset[3]{};
  float to_ras[3][4]{};
  char intent_name[16]{};
  char magic[4] = "n+1";
  char no_extension[4]{};
};
static_assert(sizeof(NiftiHeader) == 352);

NiftiHeader header_of(const LabelVolume& volume) {
  NiftiHeader header;
  constexpr float kLpsToRas[] = {-1, -1, 1};
  for (const std::size_t axis : {0u, 1u, 2u}) {
    const auto step = static_cast<float>(volume.spacing_mm[static_cast<Eigen::Index>(axis)]);
    const auto origin = static_cast<float>(volume.origin_mm[static_cast<Eigen::Index>(axis)]);
    header.dim[axis + 1] = static_cast<std::int16_t>(volume.dims[axis]);
    header.pixdim[axis + 1] = step;
    header.offset[axis] = header.to_ras[axis][3] = kLpsToRas[axis] * origin;
    header.to_ras[axis][axis] = kLpsToRas[axis] * step;
  }
  return header;
}

}  // namespace

Result<void> write_nifti(const LabelVolume& volume, const std::filesystem::path& path) {
  const NiftiHeader header = header_of(volume);
  const std::string_view bytes(reinterpret_cast<const char*>(&header), sizeof header);
  return write_voxel_file(path, bytes, volume.labels, path.extension() == ".gz" ? Packed::all : Packed::nothing);
}

}  // namespace sonoloft
