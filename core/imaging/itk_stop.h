#ifndef FASCICLE_CORE_IMAGING_ITK_STOP_H_
#define FASCICLE_CORE_IMAGING_ITK_STOP_H_

#include <itkEventObject.h>
#include <itkProcessObject.h>

#include <stop_token>

#include "core/base/stop.h"

namespace fascicle {

// Runs a filter of ITK, which ends early and throws Stopped after a stop request. The filter's own progress is when it
// is asked: between iterations, and between parts of the image in filters that report them. For this room alone.
inline void UpdateUnlessStopped(itk::ProcessObject& filter, const std::stop_token& stop) {
  ThrowIfStopped(stop);
  // A filter looks at this flag itself when it reports progress, perhaps from several threads; but not all look at it
  // between iterations, of which they tell in the calling thread.
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
