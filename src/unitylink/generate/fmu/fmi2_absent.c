/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Functions of FMI 2.0 that are for what this unit does not have. The standard wants them to be there. They fail.
 */
#include "fmi2.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#define NOT_HERE \
  { return (void)failed(component, "this unit has no such function"), fmi2Error; }
#define OF fmi2Component component, const fmi2ValueReference references[], size_t count

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) NOT_HERE EXPORT fmi2Status
    fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) NOT_HERE EXPORT fmi2Status
    fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) NOT_HERE EXPORT fmi2Status
    fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) NOT_HERE EXPORT fmi2Status
    fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte to[],
                          size_t size) NOT_HERE EXPORT fmi2Status
    fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte from[], size_t size,
                            fmi2FMUstate* state) NOT_HERE EXPORT fmi2Status
    fmi2GetDirectionalDerivative(OF, const fmi2ValueReference knowns[], size_t known_count, const fmi2Real seed[],
                                 fmi2Real to[]) NOT_HERE EXPORT fmi2Status
    fmi2SetRealInputDerivatives(OF, const fmi2Integer orders[], const fmi2Real values[]) NOT_HERE EXPORT fmi2Status
    fmi2GetRealOutputDerivatives(OF, const fmi2Integer orders[], fmi2Real values[]) NOT_HERE EXPORT fmi2Status
    fmi2CancelStep(fmi2Component component) NOT_HERE EXPORT fmi2Status
    fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status* value) NOT_HERE EXPORT fmi2Status
    fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real* value) NOT_HERE EXPORT fmi2Status
    fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind,
                         fmi2Integer* value) NOT_HERE EXPORT fmi2Status
    fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind,
                         fmi2Boolean* value) NOT_HERE EXPORT fmi2Status
    fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String* value) NOT_HERE
