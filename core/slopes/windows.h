#pragma once

namespace sonoloft {

/// How far along contours, and how near to a plane, slopes and curvatures look. In features (about a 60th of the
/// object, ContourSlopes), of which docs/pipeline/12-slopes.md says what was measured; the response to each is flat.
inline constexpr double kTangentReach = 1.4;
inline constexpr double kTangentReachOfLength = 0.1;  ///< at most this share of the contour: small ones are round too
inline constexpr double kCurvatureReach = 2.8;
inline constexpr double kCurvatureReachOfLength = 0.12;
inline constexpr double kSmoothingReach = 1.4;
inline constexpr double kShortestOpenArc = 5.6;     ///< below, its curvature would be that of its ends
inline constexpr double kGreatestCurvature = 0.85;  ///< per feature
inline constexpr double kStationStep = 0.6;         ///< slopes from planes are computed at places this far apart
inline constexpr double kLeastHeight = 1;           ///< nearer planes weigh no more
inline constexpr double kCrossingTolerance = 0.3;   ///< between where two contours meet their planes' common line

inline constexpr double kShareOfClearance = 0.15;  ///< of the way to the middle between two borders
inline constexpr double kClearanceReach = 8;       ///< borders farther apart do not mind each other
inline constexpr double kGreatestSlope = 2;

inline constexpr double kCalmingReach = 16;         ///< in standard deviations of the contour's noise
inline constexpr double kGreatestCalmingReach = 3;  ///< however rough it is
inline constexpr double kGreatestCalming = 3;       ///< standard deviations that a point may move

}  // namespace sonoloft
