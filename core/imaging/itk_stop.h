#ifndef FASCICLE_CORE_IMAGING_ITK_STOP_H_
#define FASCICLE_CORE_IMAGING_ITK_STOP_H_

#include <itkEventObject.h>
#include <itkProcessObject.h>

#include <stop_token>

#include "core/base/stop.h"

namespace fascicle {

// Runs an ITK filter, which ends early and throws Stopped after a stop request. It is checked when the filter reports
// progress: between iterations, and between parts of the image in filters that report them. Internal to this room.
inline void UpdateUnlessStopped(itk::ProcessObject& filter, const std::stop_token& stop) {
  ThrowIfStopped(stop);
  // Filters check this flag when they report progress, perhaps from several threads. Not all check it between
  // iterations, which they report in the calling thread.
  filter.AddObserver(itk::ProgressEvent(), [&](const itk::EventObject&) {
    if (stop.stop_requested()) filter.AbortGenerateDataOn();
  });
  filter.AddObserver(itk::IterationEvent(), [&](const itk::EventObject&) { ThrowIfStopped(stop); });
  try {
    filter.Update();
  } catch (const itk::ProcessAborted&) {
    throw Stopped();
  }
  filter.RemoveAllObservers();
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_STOP_H_
